// SPDX-License-Identifier: GPL-2.0-or-later
/// Checkpoints of both programs at one interval, and what goes on from them; the overlapped
/// schedule.
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <random>
#include <sstream>

#include "protocol/transport/trace_compare.h"
#include "tests/support/coupled_job.h"

namespace {

using test::JobResult;
using test::kLbm;
using test::kLiggghts;

/// A scene of cases/ with an overlay, run in a folder of its own.
class CheckpointTest : public testing::Test {
 protected:
  void use(const std::string& scene, const std::string& overlay) {
    case_ = BPLBM_SOURCE_DIR "/cases/" + scene;
    folder_.write("overlay.toml", overlay);
  }
  std::string job(const std::string& out, const std::string& options, int solid_ranks = 1,
                  const std::string& lbm = kLbm) const {
    return test::mpirun({lbm + " " + case_ + "/scene.toml overlay.toml --progress none --out " +
                         out + " " + options},
                        {kLiggghts + " -in " + case_ +
                             "/in.liggghts -log none -screen none -var "
                             "out_folder " +
                             out,
                         solid_ranks});
  }
  JobResult run(const std::string& out, const std::string& options = "", int solid_ranks = 1,
                double limit = 60.0) const {
    return test::run(job(out, options, solid_ranks), folder_.path(), limit);
  }
  void expect_ok(const JobResult& result) const { ASSERT_EQ(result.exit_code, 0) << result.output; }
  std::string file(const std::string& name) const {
    return test::read_file(folder_.path() + "/" + name);
  }
  /// The first line that differs says more than two whole files.
  void expect_same(const std::string& name) const {
    std::istringstream a(file("whole/" + name)), b(file("parts/" + name));
    std::string in_whole, in_parts;
    for (int line = 1; in_whole == in_parts; ++line) {
      const bool more = static_cast<bool>(std::getline(a, in_whole));
      if (more != static_cast<bool>(std::getline(b, in_parts))) {
        ADD_FAILURE() << name << " ends at line " << line << (more ? " in parts" : " in whole");
        return;
      }
      if (!more) return;
      EXPECT_EQ(in_whole, in_parts) << name << ", line " << line;
    }
  }
  std::vector<std::string> solid_checkpoints(const std::string& out) const {
    std::vector<std::string> names;
    for (const auto& entry : std::filesystem::directory_iterator(folder_.path() + "/" + out))
      if (entry.path().extension() == ".solid") names.push_back(entry.path().filename());
    return names;
  }
  std::string case_;
  test::TemporaryFolder folder_;
};

// Bonds that break, walls with friction, two ranks: all that a restart file must hold.
// The default suite holds the same of a smaller block (stopped_run_test).
class BreakingBlock : public CheckpointTest {
 protected:
  void expect_to_the_bit(const std::string& schedule) {
    use("hydraulic_fracture",
        "[run]\nend_time = 0.006\ncheckpoint_every = 0.001\n[output]\nprobe_every = 1e-4\n"
        "fields_every = 0.002\n[coupling]\nschedule = \"" +
            schedule + "\"\n");
    const double limit = 240.0;  // two programs wait for each other in each of 5400 intervals
    expect_ok(run("whole", "", 2, limit));
    expect_ok(run("parts", "--until 0.0052", 2, limit));
    const JobResult rest = run("parts", "--restart", 2, limit);
    expect_ok(rest);
    EXPECT_NE(rest.output.find("goes on from"), std::string::npos) << rest.output;
    expect_same("probes.csv");
    expect_same("breaks.csv");
    EXPECT_GT(file("whole/breaks.csv").size(), 200U);  // something broke
    EXPECT_EQ(solid_checkpoints("parts").size(), 3U);
  }
};

TEST_F(BreakingBlock, Slow_OverlappedGoesOnToTheBit) {
  expect_to_the_bit("overlapped");
}
TEST_F(BreakingBlock, Slow_SerialGoesOnToTheBit) {
  expect_to_the_bit("serial");
}

TEST_F(CheckpointTest, ASignalEndsBothWithACheckpoint) {
  use("settling_disc",
      "[run]\nend_time = 0.25\ncheckpoint_every = 10.0\n[numerics]\n"
      "cells_per_diameter = 20\n[output]\nfields_every = 1.0\n");
  expect_ok(run("whole"));
  const JobResult cut =
      test::run("(" + job("parts", "") +
                    ") & job=$!; until [ -s parts/probes.csv ]; do sleep 0.05; "
                    "done; sleep 0.2; pkill -TERM -x -P $job lbm; wait $job; echo code $?",
                folder_.path(), 60.0);
  EXPECT_NE(cut.output.find("code 1"), std::string::npos) << cut.output;
  EXPECT_NE(cut.output.find("stopped by a signal; --restart goes on"), std::string::npos)
      << cut.output;
  ASSERT_EQ(solid_checkpoints("parts").size(), 1U) << cut.output;
  expect_ok(run("parts", "--restart"));
  // the whole run wrote no checkpoint there, so its particles were not set up anew: one disc, alike
  expect_same("probes.csv");
}

/// lbm where no file may grow beyond 1.6 MB: room for a checkpoint, not for all frames of the
/// fields.
const std::string kShortOfDisk =
    "sh " BPLBM_SOURCE_DIR "/tests/support/short_of_disk.sh 1600 " + kLbm;

// The fluid cannot write its fields; both stand at one interval and keep their states.
TEST_F(CheckpointTest, AFaultKeepsTheStatesOfBoth) {
  for (const int ranks : {1, 2}) {
    use("settling_disc",
        "[run]\nend_time = 0.3\ncheckpoint_every = 10.0\n[numerics]\ncells_per_diameter = 10\n"
        "[output]\nfields_every = 0.02\nprobe_every = 0.002\n");
    expect_ok(run("whole", "", ranks));
    std::filesystem::remove_all(folder_.path() + "/parts");
    const JobResult cut = test::run(job("parts", "", ranks, kShortOfDisk), folder_.path(), 60.0);
    EXPECT_EQ(cut.exit_code, 1) << cut.output;
    EXPECT_NE(cut.output.find("is the disk full?"), std::string::npos) << cut.output;
    EXPECT_NE(cut.output.find("last state is kept in parts/fault.h5"), std::string::npos)
        << cut.output;
    ASSERT_EQ(solid_checkpoints("parts").size(), 1U) << cut.output;
    expect_ok(run("parts", "--restart=fault", ranks));
    expect_same("probes.csv");
  }
}

TEST_F(CheckpointTest, AFaultOfOneAloneIsNoPlaceToGoOnFrom) {
  use("settling_disc",
      "[run]\nend_time = 100.0\ncheckpoint_every = 0.05\n[numerics]\ncells_per_diameter = 10\n"
      "[output]\nfields_every = 100.0\n");
  const JobResult cut =
      test::run("(" + job("parts", "") +
                    ") & job=$!; until [ -s parts/checkpoint.h5 ]; do sleep 0.05; done; "
                    "pkill -KILL -x -P $job liggghts; wait $job",
                folder_.path(), 60.0);
  EXPECT_FALSE(cut.timed_out) << cut.output;
  EXPECT_EQ(run("parts", "--restart=fault --until 90").exit_code, 2);
  // Whether the fluid lived long enough to keep its state is chance; both are refused by name.
  const std::string fault = folder_.path() + "/parts/fault.h5";
  std::filesystem::remove(fault);
  const auto says = [&](const std::string& words) {
    const JobResult rest = run("parts", "--restart=fault --until 90");
    EXPECT_EQ(rest.exit_code, 2);
    EXPECT_NE(rest.output.find(words), std::string::npos) << rest.output;
  };
  says("fault.h5: no checkpoint to restart from");
  std::filesystem::copy_file(folder_.path() + "/parts/checkpoint.h5", fault);  // the fluid's alone
  says("is missing: the solid's part of the checkpoint");
}

TEST_F(CheckpointTest, SaysWhatIsMissing) {
  use("settling_disc", "[run]\nend_time = 0.02\ncheckpoint_every = 0.005\n");
  JobResult job = run("out", "--restart");
  EXPECT_EQ(job.exit_code, 2);
  EXPECT_NE(job.output.find("out/checkpoint.h5: no checkpoint to restart from"), std::string::npos)
      << job.output;
  expect_ok(run("out"));
  job = run("out", "--restart");
  EXPECT_EQ(job.exit_code, 2);
  EXPECT_NE(job.output.find("lies at the end of the run"), std::string::npos) << job.output;
  expect_ok(run("out", "--until 0.013"));
  for (const std::string& name : solid_checkpoints("out"))
    std::filesystem::remove(folder_.path() + "/out/" + name);
  job = run("out", "--restart");
  EXPECT_EQ(job.exit_code, 2);
  EXPECT_NE(job.output.find("is missing: the solid's part of the checkpoint"), std::string::npos)
      << job.output;
}

// Loads one interval late: 1 % of the largest speed for a disc that accelerates in some 20 steps.
TEST_F(CheckpointTest, TheOverlappedScheduleFallsAlike) {
  const auto states = [&](const std::string& schedule, int ranks) {
    use("settling_disc",
        "[run]\nend_time = 0.2\n[numerics]\ncells_per_diameter = 10\n[coupling]\n"
        "schedule = \"" +
            schedule + "\"\n");
    const std::string name = schedule + std::to_string(ranks);
    expect_ok(run(name, "--record " + name + ".h5", ranks));
    return protocol::timeline(protocol::Trace(folder_.path() + "/" + name + ".h5"));
  };
  const auto serial = states("serial", 1), one = states("overlapped", 1),
             two = states("overlapped", 2);
  ASSERT_EQ(one.size(), serial.size());
  ASSERT_EQ(two.size(), one.size());
  double fastest = 0.0, largest = 0.0;
  for (std::size_t k = 0; k < serial.size(); ++k) {
    fastest = std::max(fastest, std::abs(serial[k].states[0].v[1]));
    largest = std::max(largest, std::abs(serial[k].states[0].v[1] - one[k].states[0].v[1]));
    EXPECT_NEAR(two[k].states[0].v[1], one[k].states[0].v[1], 1e-12);
  }
  EXPECT_LT(largest / fastest, 0.01);
  EXPECT_GT(largest, 0.0);  // it is another schedule
}

TEST_F(CheckpointTest, Slow_KilledTwentyTimesItAlwaysGoesOn) {
  use("settling_disc",
      "[run]\nend_time = 8.0\ncheckpoint_every = 0.05\n[output]\n"
      "fields_every = 10.0\nprobe_every = 0.01\n");
  const auto start = std::chrono::steady_clock::now();
  expect_ok(run("whole", "", 1, 300.0));
  const std::chrono::duration<double> whole = std::chrono::steady_clock::now() - start;
  std::mt19937 random(7);
  // So long that most trials get to a checkpoint, and so short that none gets to the end.
  std::uniform_real_distribution<double> moment(0.025 * whole.count(), 0.06 * whole.count());
  for (int trial = 0; trial < 20; ++trial) {
    const bool first = !std::filesystem::exists(folder_.path() + "/parts/checkpoint.h5");
    const char* victim = trial % 3 == 0 ? "lbm" : trial % 3 == 1 ? "liggghts" : "mpirun";
    const JobResult cut = test::run(
        "(" + job("parts", first ? "" : "--restart") + ") & job=$!; sleep " +
            std::to_string(moment(random)) + "; children=$(pgrep -P $job); " +
            (std::string(victim) == "mpirun" ? "kill -KILL $job"
                                             : "pkill -KILL -x -P $job " + std::string(victim)) +
            "; sleep 0.1; kill -KILL $children $job 2> /dev/null; wait $job; true",
        folder_.path(), 60.0);
    ASSERT_FALSE(cut.timed_out);
    EXPECT_EQ(cut.output.find("is missing"), std::string::npos) << trial << cut.output;
    EXPECT_EQ(cut.output.find("checkpoint to restart"), std::string::npos) << trial << cut.output;
  }
  expect_ok(run("parts", "--restart", 1, 300.0));
  expect_same("probes.csv");
}

}  // namespace
