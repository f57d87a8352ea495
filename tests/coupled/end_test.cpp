// SPDX-License-Identifier: GPL-2.0-or-later
/// The end of a job, as protocol/WIRE.md has it: whoever leaves, at whatever stage and however,
/// the other side ends in time and says why.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <future>
#include <regex>
#include <tuple>

#include "tests/support/coupled_job.h"

namespace {

using test::expect_end;
using test::JobResult;
using test::kLbm;
using test::kLiggghts;
using test::mpirun;
using test::SettlingDisc;

const std::string kPeer = test::kBin + "/scripted_peer solid leave ";
const std::string kPython =
    "env PYTHONPATH=" BPLBM_SOURCE_DIR "/protocol/python /usr/bin/python3 " BPLBM_SOURCE_DIR
    "/tests/support/leaving_peer.py ";

const std::string kC = test::kBin + "/leaving_solid ";

/// A short run with a short time-out.
class Scene : public SettlingDisc {
 public:
  Scene() {
    change_scene("timeout = 60.0", "timeout = 4.0");
    change_scene("end_time = 0.04", "end_time = 0.01");
  }
  std::string job(const std::string& solid, int fluid_ranks = 1, int solid_ranks = 1) const {
    return mpirun({kLbm + " --progress none", fluid_ranks}, {solid, solid_ranks});
  }
};

// ---- a solid that leaves -----------------------------------------------------------------------

/// A stage at which a solid leaves, what the fluid says then, and the fluid's exit code.
struct Stage {
  std::string name, lacking, said;
  int exit_code;
};

const std::vector<Stage> kStages{
    {"connected", "its handshake", "", 1},
    {"hello", "its answer to our handshake", "", 1},
    {"agreed", "the states of interval 0", "", 1},
    {"states", "the states of interval 1", "", 1},
    {"running", "the states of interval 3", "", 1},
    {"last", "", "ending       complete", 0},
    {"goodbye", "", "ending       stopped by solid: has seen enough", 0},
    {"refused", "", "fluid and solid disagree:\n  - gravity", 2},
    {"version", "", "protocol version: partner speaks 3", 2},
};

struct Leaving {
  std::string name, peer, how;
};
void PrintTo(const Leaving& l, std::ostream* out) {
  *out << l.name;
}

class LeavingSolid : public testing::TestWithParam<Leaving> {};

// All stages at once: they wait most of the time. An exit without MPI_Finalize is a fault to
// mpirun, which ends the rest, whatever the stage.
TEST_P(LeavingSolid, EndsTheFluidAtEveryStage) {
  const auto& [name, peer, how] = GetParam();
  std::vector<std::pair<const Stage*, std::future<JobResult>>> jobs;
  for (const Stage& stage : kStages) {
    if (peer != kPeer && (stage.name == "hello" || stage.name == "version"))
      continue;  // Python's and C's interfaces send their handshake and their answer at once
    jobs.emplace_back(&stage, std::async(std::launch::async, [&stage, &peer = peer, &how = how] {
      const Scene scene;
      return test::run(scene.job(peer + stage.name + " " + how), scene.folder(), 50.0);
    }));
  }
  for (auto& [stage, result] : jobs) {
    SCOPED_TRACE(stage->name);
    std::string said = stage->said;
    if (!stage->lacking.empty())
      said = (how == "farewell" ? "solid rank 0 left without "
                                : "no answer from solid rank 0 for 4 s while waiting for ") +
             stage->lacking;
    // The library answers for its process, so the fluid knows that it does nothing any more.
    const bool asked = peer == kC && how == "finalize" && stage->exit_code == 0;
    // The C interface says by itself that it was not closed; behind MPI_Finalize mpirun shows
    // nothing more.
    if (how == "exit")
      expect_end(result.get(), 1,
                 {peer == kC ? "leaving_solid | error | it ends without bplbm_close" : ""});
    else if (asked)
      expect_end(result.get(), 1, {said, "solid rank 0 did not end within 4 s, and did nothing"});
    else
      expect_end(result.get(), stage->exit_code, {said});
  }
}

INSTANTIATE_TEST_SUITE_P(All, LeavingSolid,
                         testing::Values(Leaving{"CppByFinalize", kPeer, "finalize"},
                                         Leaving{"CppByExit", kPeer, "exit"},
                                         Leaving{"CppWithFarewell", kPeer, "farewell"},
                                         Leaving{"CByFinalize", kC, "finalize"},
                                         Leaving{"CByExit", kC, "exit"},
                                         Leaving{"CWithFarewell", kC, "farewell"},
                                         Leaving{"PythonByFinalize", kPython, "finalize"},
                                         Leaving{"PythonByExit", kPython, "exit"},
                                         Leaving{"PythonWithFarewell", kPython, "farewell"}),
                         [](const auto& info) { return info.param.name; });

// No crash, no wait for the time-out: the library says which call was wrong.
TEST(MisuseInC, IsNamedAtOnce) {
  const std::tuple<const char*, int, const char*> calls[] = {
      {"scene", 2, "bplbm_scene: give a setup"},
      {"number", 2, "bplbm_number: give a name and a place"},
      {"place", 2, "bplbm_number: give a name and a place"},
      {"agree", 2, "bplbm_agree: both have agreed already"},
      {"receive", 2, "bplbm_receive: no states are sent; call bplbm_send first"},
      {"send", 2, "bplbm_send: these states are sent; call bplbm_receive"},
      {"goodbye", 2, "bplbm_exchange: bplbm_goodbye was called"},
      {"checkpoint", 2, "bplbm_checkpoint: the last loads did not ask for one"},
      {"clump", 2, "bplbm_clump: sphere 2 is at (0, 0, 0) m with a radius of -1 m"},
      {"no_clump", 2, "bplbm_clump: give places and radii of at least one sphere"},
      {"code", 1, "has had enough"},
      {"connect", 2, "bplbm_connect: this process is connected already"},
  };
  std::vector<std::future<JobResult>> jobs;
  for (const auto& [call, code, said] : calls)
    jobs.push_back(std::async(std::launch::async, [call = call] {
      const Scene scene;
      return test::run(scene.job(kC + "misuse " + call), scene.folder(), 50.0);
    }));
  for (std::size_t k = 0; k < jobs.size(); ++k) {
    const auto& [call, code, said] = calls[k];
    SCOPED_TRACE(call);
    expect_end(jobs[k].get(), code,
               {std::string("leaving_solid | error | ") + (code == 2 ? said : ""), said});
  }
}

// A Python engine that leaves its `with` block, without a word, says goodbye.
TEST(PythonBlock, SaysGoodbyeWhenItIsLeft) {
  const Scene scene;
  for (const int ranks : {1, 2})
    expect_end(test::run(scene.job(kPython + "block farewell", ranks), scene.folder(), 50.0), 0,
               {"ending       stopped by solid: leaving_peer ended"});
}

TEST(FailingSolid, InCTellsTheFluidAtEveryStage) {
  std::vector<std::future<JobResult>> jobs;
  for (const char* stage : {"connected", "agreed", "states", "running"})
    jobs.push_back(std::async(std::launch::async, [stage] {
      const Scene scene;
      return test::run(scene.job(kC + stage + " fail"), scene.folder(), 50.0);
    }));
  for (auto& job : jobs)
    expect_end(job.get(), 42,
               {"leaving_solid | error | has had enough",
                "lbm | error | the solid program stopped: has had enough"});
}

// One rank imports slowly: the others, whose own patience is a second, wait as the scene says.
TEST(PythonStart, WaitsForAsLongAsTheSceneSays) {
  const Scene scene;
  const std::string solid = "env BPLBM_CONNECT_TIMEOUT=1 " + kPython + "late farewell";
  expect_end(test::run(scene.job(solid, 1, 2), scene.folder(), 50.0), 0, {"ending       complete"});
}

TEST(LeavingFluid, EndsLiggghts) {
  Scene scene;
  const auto job =
      test::run(mpirun({test::kBin + "/scripted_peer fluid leave"}, {kLiggghts + " -screen none"}),
                scene.folder(), 50.0);
  expect_end(job, 1, {"liggghts | error | fluid rank 0 left without its handshake"});
}

TEST(Disagreement, OfARecordingEndsBoth) {
  Scene scene;
  ASSERT_EQ(scene.run("--record trace.h5").exit_code, 0);
  scene.change_scene("depth = 1.0", "depth = 2.0");
  const auto job =
      test::run(scene.job(test::kReplay + " --as solid trace.h5"), scene.folder(), 50.0);
  expect_end(job, 2,
             {"lbm | error | fluid and solid disagree", "replay | error | fluid and solid"});
}

// ---- a process that stands still ---------------------------------------------------------------

/// How a job comes to a stage and stays there for a while: what the scene and the script have for
/// it, and a shell command that waits until it has come there.
struct Phase {
  std::string name, end_time, fields_every, before, after, reached;
};
void PrintTo(const Phase& p, std::ostream* out) {
  *out << p.name;
}

class Stopped : public testing::TestWithParam<Phase> {
 protected:
  static JobResult run(const Phase& phase, int fluid_ranks, const std::string& program, int rank) {
    SettlingDisc scene;
    // long beside the 1.5 s which a script sleeps, so that a busy machine's delays name nobody
    scene.change_scene("timeout = 60.0", "timeout = 5.0");
    scene.change_scene("end_time = 0.04", "end_time = " + phase.end_time);
    scene.change_scene("fields_every = 0.05", "fields_every = " + phase.fields_every);
    scene.set_script(phase.before + scene.script() + phase.after);
    const std::string job =
        mpirun({kLbm + " --progress none", fluid_ranks}, {kLiggghts + " -screen none", 2});
    return test::run("(" + job + ") & job=$!; " + phase.reached +
                         "; kill -STOP $(pgrep -x -P $job " + program + " | sort -n | sed -n " +
                         std::to_string(rank + 1) + "p); wait $job",
                     scene.folder(), 50.0);
  }

  static void expect_named(const JobResult& result, const std::string& who) {
    SCOPED_TRACE(who);
    EXPECT_FALSE(result.timed_out) << "hangs: " << result.output;
    EXPECT_EQ(result.exit_code, 1) << result.output;
    EXPECT_NE(result.output.find("| error | " + who + " does not answer"), std::string::npos)
        << result.output;
  }
};

TEST_P(Stopped, EndsTheJobWithItsName) {
  std::vector<std::pair<std::string, std::future<JobResult>>> jobs;
  for (const int rank : {0, 1}) {
    const std::string number = std::to_string(rank);
    jobs.emplace_back("fluid rank " + number,
                      std::async(std::launch::async, run, GetParam(), 2, "lbm", rank));
    jobs.emplace_back("solid rank " + number,
                      std::async(std::launch::async, run, GetParam(), 2, "liggghts", rank));
  }
  for (auto& [who, job] : jobs) expect_named(job.get(), who);
}

// One after the other: with five processes each, jobs side by side would wait for the cores.
TEST_P(Stopped, Slow_OneOfThreeAndTwo) {
  for (const int rank : {0, 1, 2})
    expect_named(run(GetParam(), 3, "lbm", rank), "fluid rank " + std::to_string(rank));
  for (const int rank : {0, 1})
    expect_named(run(GetParam(), 3, "liggghts", rank), "solid rank " + std::to_string(rank));
}

const std::string kUntilItRuns = "until [ -s out/probes.csv ]; do sleep 0.1; done; sleep 0.5";
INSTANTIATE_TEST_SUITE_P(
    At, Stopped,
    testing::Values(Phase{"SetUp", "1000.0", "0.05", "shell sleep 1.5\n", "",
                          "until [ -e out/lbm.log ]; do sleep 0.1; done; sleep 0.3"},
                    Phase{"Running", "1000.0", "1000.0", "", "", kUntilItRuns},
                    Phase{"Output", "1000.0", "0.001", "", "", kUntilItRuns},
                    Phase{"End", "0.01", "0.05", "", "\nshell sleep 1.5\n",
                          "until [ -e out/summary.json ]; do sleep 0.1; done; sleep 0.3"}),
    [](const auto& info) { return info.param.name; });

// Without a partner whose time-out would end it.
TEST(StoppedFluidAlone, IsNamedByItsNeighbour) {
  const test::TemporaryFolder folder;
  folder.write("longer.toml", "[run]\nend_time = 1000.0\n");
  const std::string job =
      "exec env OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1 "
      "OMPI_MCA_mpi_yield_when_idle=1 BPLBM_TIMEOUT=4 mpirun --bind-to none --oversubscribe -np "
      "2 " +
      kLbm + " " BPLBM_SOURCE_DIR "/cases/shear_layer/scene.toml longer.toml --progress none";
  expect_end(test::run("(" + job +
                           ") & job=$!; until [ -e out/lbm.log ]; do sleep 0.1; done; sleep 0.5; "
                           "kill -STOP $(pgrep -x -P $job lbm | "
                           "sort -n | sed -n 2p); wait $job",
                       folder.path(), 50.0),
             1, {"lbm | error | fluid rank 1 does not answer"});
}

// Both on one core, where MPI hands it over at every turn of a poll.
TEST(EndlessScript, EndsWithTheTimeOut) {
  Scene scene;
  scene.set_script("label a\njump SELF a\n");
  const auto job =
      test::run("taskset -c 0 sh -c '" + scene.job(kLiggghts + " -screen none -log none") + "'",
                scene.folder(), 50.0);
  expect_end(job, 1, {"no answer from solid rank 0 for 4 s while waiting for its handshake"});
}

// ---- libraries that know the world only --------------------------------------------------------

constexpr const char* kFloor = R"(solid floor
facet normal 0 1 0
outer loop
vertex 0.002 0.004 -0.4
vertex 0.018 0.004 -0.4
vertex 0.018 0.004 0.4
endloop
endfacet
facet normal 0 1 0
outer loop
vertex 0.002 0.004 -0.4
vertex 0.018 0.004 0.4
vertex 0.002 0.004 0.4
endloop
endfacet
endsolid floor
)";

/// Not called on the world: those that need a topology or a partner's communicator, or start
/// others.
bool needs_another(const std::string& name) {
  static const std::regex needs(
      "MPI_(In|N)eighbor_.*|MPI_Cart_(coords|get|rank|shift|sub)|MPI_Cartdim_get|"
      "MPI_Graph_(get|neighbors.*)|MPI_Graphdims_get|MPI_Dist_graph_neighbors.*|"
      "MPI_Comm_remote_.*|MPI_Intercomm_merge|MPI_Comm_(accept|connect|spawn.*|call_errhandler)");
  return std::regex_match(name, needs);
}

TEST(WorldOfALibrary, IsItsOwnProgramInEveryCall) {
  const test::TemporaryFolder folder;
  const std::string caller = test::kBin + "/world_caller";
  const auto job = test::run(mpirun({caller + " idle"}, {caller, 2}), folder.path(), 50.0);
  expect_end(job, 0, {});
  for (const char* name : {
#define X(name) #name,
#include "mpi_calls.inc"
#undef X
       })
    EXPECT_NE(needs_another(name),
              job.output.find(std::string("called ") + name + "\n") != std::string::npos)
        << name;
}

TEST(VtkDumps, WorkOnTwoSolidRanks) {
  Scene scene;
  std::ofstream(scene.folder() + "/floor.stl") << kFloor;
  scene.change_script("run              ${solid_steps_total}",
                      "fix floor all mesh/surface file floor.stl type 1\n"
                      "dump meshes all mesh/vtk 200 mesh*.vtk id\n"
                      "dump atoms all custom/vtk 200 atoms*.vtk id x y z\n"
                      "run ${solid_steps_total}");
  expect_end(scene.run("", 2), 0, {"ending       complete"});
  for (const char* name : {"mesh0.vtk", "mesh400.vtk", "atoms0.vtk", "atoms400.vtk"})
    EXPECT_TRUE(std::filesystem::file_size(scene.folder() + "/" + name) > 100) << name;
}

}  // namespace
