// SPDX-License-Identifier: GPL-2.0-or-later
/// Every engine before the same judge (bplbm-conformance), and the same scenes with two of them.
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <future>
#include <sstream>

#include "tests/support/coupled_job.h"

namespace {

const std::string kEngines = BPLBM_SOURCE_DIR "/tools/engines/";
const std::string kPython = "/usr/bin/python3 ";

/// Command of an engine before the judge.
std::string command(const std::string& engine) {
  const std::string script = kEngines + "conformance/in." + engine + " -screen none -log none";
  if (engine == "liggghts") return test::kLiggghts + " -in " + script;
  if (engine == "lammps") return test::kBin + "/lammps_engine -in " + script;
  if (engine == "clumps") return kPython + kEngines + "python/clump_engine.py";
  if (engine == "reference" || engine == "c" || engine == "fortran")
    return test::kBin + "/" + engine + "_engine";
  return kPython + kEngines + engine + "/engine.py";
}

bool installed(const std::string& engine) {
  if (engine == "fortran") return std::filesystem::exists(test::kBin + "/fortran_engine");
  return engine != "yade" || std::filesystem::exists("/usr/bin/yade");
}

const std::string kJudge = "exec " + test::kBin + "/bplbm-conformance ";

class EngineTest : public testing::TestWithParam<std::string> {
 protected:
  EngineTest() {
    if (!installed(GetParam()))
      skip_ = GetParam() + " is not installed (apt-get install yade gfortran)";
  }
  void judge(const std::string& options) const {
    if (!skip_.empty()) GTEST_SKIP() << skip_;
    const test::TemporaryFolder folder;
    const auto job =
        test::run(kJudge + options + " -- " + command(GetParam()), folder.path(), 400.0);
    EXPECT_FALSE(job.timed_out) << job.output;
    EXPECT_EQ(job.exit_code, 0) << job.output;
  }
  std::string skip_;
};

// Most of them wait for something most of the time. YADE imports for seconds, on a busy machine for
// half a minute.
TEST_P(EngineTest, PassesEveryCheck) {
  judge(GetParam() == "yade" ? "--jobs 2 --patience 60 --timeout 90" : "--jobs 6");
}
INSTANTIATE_TEST_SUITE_P(All, EngineTest,
                         testing::Values("liggghts", "lammps", "yade", "reference", "python", "c",
                                         "fortran"),
                         [](const auto& info) { return info.param; });

class EngineOfManyRanks : public EngineTest {};
TEST_P(EngineOfManyRanks, PassesWithTwoOnBothSides) {
  judge(
      "--jobs 4 --fluid-ranks 2 --solid-ranks 2 "
      "move mass collide corner vanish late epoch checkpoint density fail fault end end_left");
}
INSTANTIATE_TEST_SUITE_P(All, EngineOfManyRanks,
                         testing::Values("liggghts", "lammps", "python", "c"),
                         [](const auto& info) { return info.param; });

class EngineOfClumps : public EngineTest {};
TEST_P(EngineOfClumps, MovesThemAsOneBody) {
  judge("clump");
  judge("clump --fluid-ranks 2");
}
INSTANTIATE_TEST_SUITE_P(All, EngineOfClumps,
                         testing::Values("liggghts", "reference", "clumps", "yade"),
                         [](const auto& info) { return info.param; });

// ---- the judge ----------------------------------------------------------------------------------

/// What an engine does wrong (tests/support/bad_engine.py), the check that must find it, and what
/// that says.
struct Sin {
  const char *name, *check, *wrong;
};
const Sin kSins[] = {
    {"half_load", "move", "impulse of an interval"},
    {"short_way", "move", "way of an interval"},
    {"unit_depth", "mass", "density 6000 kg/m³"},
    {"ring", "mass", "inertia of a disc"},
    {"no_contact", "collide", "they do not part"},
    {"no_image", "corner", "interval 2: 0 particles instead of 1"},
    {"all_vanish", "vanish", "the one that left is still there"},
    {"early", "late", "interval 0: 1 particles instead of 0"},
    {"same_epoch", "epoch", "jumped from"},
    {"only_whole_discs", "ranks", "was not sent to fluid rank 1, which it touches"},
    {"never_last", "stop", "it says not the last"},
    {"unasked_checkpoint", "checkpoint", "checkpoint not written when asked, or unasked"},
    {"no_checkpoint_file", "checkpoint", "there is no file checkpoint.3.solid"},
    {"any_version", "version", "it was not refused"},
    {"agreeable_box", "box", "it was not refused"},
    {"agreeable_density", "density", "it was not refused"},
    {"impatient", "slow_start", "no answer from fluid rank 0 for 1 s"},
    {"impatient", "slow_loads", "no answer from fluid rank 0 for 1 s"},
    {"too_patient", "silence", "it still waits after 8 s"},
    {"not_a_number_is_zero", "fail", "it went on with a load that is not finite"},
    {"deaf", "fault", "does not say farewell within 6 s after a fault"},
    {"no_farewell", "end", "does not say farewell within 6 s after its last states"},
    {"hasty_end", "end_late", "it ended before it could be judged"},
    {"stubborn", "end_refused", "does not say farewell within 6 s after a refusal"},
    {"fault_is_farewell", "end_fault", "it does not end within 8 s"},
    {"unit_depth", "clump", "1 of 1 records are no parts of a clump"},
    {"overlap_counted_twice", "clump", "density"},
    {"ball_of_a_clump", "clump", "inertia of the union"},
    {"no_turn_of_discs", "clump", "speed x of its disc"},
    {"deaf", "end_left", "does not say farewell within 6 s after the fluid's own"},
};

// All at once: they wait most of the time.
TEST(Judge, FindsEverySin) {
  std::vector<std::future<test::JobResult>> jobs;
  for (const Sin& sin : kSins)
    jobs.push_back(std::async(std::launch::async, [&sin] {
      const test::TemporaryFolder folder;
      return test::run(kJudge + sin.check + " -- " + kPython +
                           BPLBM_SOURCE_DIR "/tests/support/bad_engine.py " + sin.name,
                       folder.path(), 250.0);
    }));
  for (std::size_t i = 0; i < jobs.size(); ++i) {
    SCOPED_TRACE(std::string(kSins[i].name) + " before " + kSins[i].check);
    test::expect_end(jobs[i].get(), 1,
                     {std::string(kSins[i].check), " NO ", "wrong: ", kSins[i].wrong});
  }
}

TEST(Judge, AnswersMistakesOfItsCommandLine) {
  const test::TemporaryFolder folder;
  const auto run = [&](const std::string& words) {
    return test::run(kJudge + words, folder.path(), 50.0);
  };
  test::expect_end(run("--help"), 0, {"bplbm-conformance [CHECK…] -- ENGINE…", "end_late"});
  test::expect_end(run("move"), 2, {"which engine?"});
  test::expect_end(run("moves -- true"), 2, {"no check is called 'moves'"});
  test::expect_end(run("stop --launcher no_mpirun -- true"), 1, {"no_mpirun not found"});
  test::expect_end(run("stop --timeout 2 -- sleep 60"), 1, {"does not end within 2 s"});
  test::expect_end(run("stop --timeout 2 -- true"), 1, {"0 of 1 checks passed"});
  test::expect_end(run("silence --patience 10 -- " + kPython +
                       BPLBM_SOURCE_DIR "/tests/support/bad_engine.py too_patient"),
                   1, {"it still waits after 4 s"});
}

// As FixTest has it for LIGGGHTS: deleting the first disc gives its id to the second.
TEST(LammpsEngine, AnIdThatPassesToAnotherParticleGetsAnotherEpoch) {
  const test::TemporaryFolder folder;
  folder.write("in.lammps", R"(dimension 2
units si
atom_style sphere
atom_modify map array
boundary p p p
newton off
comm_modify vel yes
region box block 0 1 0 1 -0.5 0.5 units box
create_box 1 box
neighbor 0.02 bin
pair_style gran/hooke/history 1e5 NULL 1.0 NULL 0.3 1
pair_coeff * *
timestep 1e-3
create_atoms 1 single 0.3 0.3 0.0 units box
create_atoms 1 single 0.6 0.7 0.0 units box
set type 1 diameter 0.1
set type 1 density/disc 254.64790894703253
fix move all nve/sphere disc
fix couple all lbm/couple every 10
fix flat all enforce2d
run 20
group gone id 1
delete_atoms group gone
run 1000
)");
  const auto job =
      test::run(test::mpirun({test::kBin + "/scripted_peer fluid impulse 4"},
                             {test::kBin + "/lammps_engine -in in.lammps -screen none"}),
                folder.path(), 50.0);
  ASSERT_EQ(job.exit_code, 0) << job.output;
  std::vector<int> epochs;
  std::istringstream lines(test::read_file(folder.path() + "/peer.txt"));
  for (std::string line; std::getline(lines, line);) {
    int interval = 0, id = 0, epoch = 0;
    if (std::sscanf(line.c_str(), "state %d %d %*f %*f %*f %*f %d", &interval, &id, &epoch) == 3 &&
        id == 1)
      epochs.push_back(epoch);
  }
  EXPECT_EQ(epochs, (std::vector<int>{0, 0, 0, 3, 3}));
}

/// Command of an engine for a scene.
std::string command_for(const std::string& scene, const std::string& engine) {
  const std::string quiet = " -log none -screen none -in " + scene + "/in." + engine;
  if (engine == "liggghts") return test::kLiggghts + quiet;
  if (engine == "lammps") return test::kBin + "/lammps_engine" + quiet;
  return command(engine);
}

/// Columns y and vy of probes.csv.
std::vector<std::array<double, 2>> track(const std::string& csv) {
  std::vector<std::array<double, 2>> rows;
  std::istringstream lines(csv);
  std::string line;
  std::getline(lines, line);
  while (std::getline(lines, line)) {
    double t, id, x, y, vx, vy;
    char c;
    std::istringstream(line) >> t >> c >> id >> c >> x >> c >> y >> c >> vx >> c >> vy;
    rows.push_back({y, vy});
  }
  return rows;
}

class SameScene : public testing::TestWithParam<const char*> {};

// Until a contact the engines solve the same equation with the same scheme: round-off, amplified by
// the fluid over some thousand steps.
TEST_P(SameScene, WithAnyEngineTheDiscFallsAlike) {
  const std::string scene = BPLBM_SOURCE_DIR "/cases/" + std::string(GetParam());
  std::vector<std::vector<std::array<double, 2>>> tracks;
  const test::TemporaryFolder folder;
  folder.write("overlay.toml", "[numerics]\ncells_per_diameter = 10\n[run]\nend_time = 0.2\n");
  for (const std::string engine : {"liggghts", "lammps", "reference", "python", "yade"}) {
    if (engine == "yade" && (!installed(engine) || scene.ends_with("disc_migration")))
      continue;  // its boxes are periodic along all axes or none
    const auto job = test::run(
        test::mpirun({test::kLbm + " " + scene + "/scene.toml overlay.toml --progress none --out " +
                      engine + " --record " + engine + ".h5"},
                     {command_for(scene, engine)}),
        folder.path(), 60.0);
    ASSERT_EQ(job.exit_code, 0) << engine << job.output;
    if (engine == "liggghts" || engine == "lammps") {  // which keeps its walls to itself
      const bool said = job.output.find(
                            "does not tell its walls: they are not compared with the "
                            "fluid's") != std::string::npos;
      EXPECT_EQ(said, engine == "lammps") << job.output;
    }
    const auto diff = test::run(
        test::kBin + "/trace diff --physics --tolerance 1e-6 liggghts.h5 " + engine + ".h5",
        folder.path(), 50.0);
    EXPECT_EQ(diff.exit_code, 0) << engine << diff.output;
    tracks.push_back(track(test::read_file(folder.path() + "/" + engine + "/probes.csv")));
  }
  double fastest = 0.0;
  for (const auto& row : tracks[0]) fastest = std::max(fastest, std::abs(row[1]));
  ASSERT_GT(fastest, 0.0);
  for (std::size_t e = 1; e < tracks.size(); ++e) {
    ASSERT_EQ(tracks[e].size(), tracks[0].size());
    for (std::size_t k = 0; k < tracks[0].size(); ++k) {
      EXPECT_NEAR(tracks[e][k][1], tracks[0][k][1], 1e-8 * fastest) << e << ' ' << k;
      EXPECT_NEAR(tracks[e][k][0], tracks[0][k][0], 1e-10) << e << ' ' << k;
    }
  }
}
INSTANTIATE_TEST_SUITE_P(Scenes, SameScene, testing::Values("settling_disc", "disc_migration"),
                         [](const auto& info) { return std::string(info.param); });

// What was recorded with one engine is played to the others: none needs the fluid to be compared.
TEST(Recording, OfOneEngineIsFollowedByEveryOther) {
  const std::string scene = BPLBM_SOURCE_DIR "/cases/settling_disc";
  const test::TemporaryFolder folder;
  folder.write("overlay.toml", "[numerics]\ncells_per_diameter = 10\n[run]\nend_time = 0.1\n");
  const std::string lbm =
      test::kLbm + " " + scene + "/scene.toml overlay.toml --progress none --out out --record a.h5";
  const auto recorded =
      test::run(test::mpirun({lbm}, {command_for(scene, "python")}), folder.path(), 60.0);
  ASSERT_EQ(recorded.exit_code, 0) << recorded.output;
  for (const std::string engine : {"liggghts", "lammps", "reference", "python", "yade"}) {
    if (!installed(engine)) continue;
    const auto job =
        test::run(test::mpirun({test::kReplay + " --as fluid --physics --tolerance 1e-9 a.h5"},
                               {command_for(scene, engine)}),
                  folder.path(), 60.0);
    EXPECT_EQ(job.exit_code, 0) << engine << job.output;
    EXPECT_NE(job.output.find("replay | states | "), std::string::npos) << engine << job.output;
  }
}

// Three discs in an L, joined by YADE's own cohesive bonds: the fluid hears what becomes of them.
TEST(Yade, BondsHoldOrBreakAndTheFluidIsTold) {
  if (!installed("yade")) GTEST_SKIP() << "yade is not installed";
  const test::TemporaryFolder folder;
  for (const auto& [strength, told] :
       {std::pair{"1.0", "bonds 2 (broken by tension 0, by shear 0)"},
        {"0.01", "bonds 0 (broken by tension 2, by shear 0)"}}) {
    folder.write("bonded.toml",
                 "[particles]\nstart = [[0.01, 0.04], [0.01, 0.0425], [0.0125, 0.0425]]\n"
                 "[particles.variables]\nbonded = 1\nbond_strength = " +
                     std::string(strength) +
                     "\n[numerics]\ncells_per_diameter = 10\n[run]\nend_time = 0.1\n");
    const auto job =
        test::run(test::mpirun({test::kLbm + " " BPLBM_SOURCE_DIR "/cases/settling_disc/scene.toml "
                                             "bonded.toml --progress none --out out --force"},
                               {command("yade")}),
                  folder.path(), 60.0);
    EXPECT_EQ(job.exit_code, 0) << job.output;
    EXPECT_NE(job.output.find(told), std::string::npos) << job.output;
  }
}

class EngineRestart : public testing::TestWithParam<const char*> {
 protected:
  void SetUp() override {
    if (!installed(GetParam())) GTEST_SKIP() << GetParam() << " is not installed";
    folder_.write("overlay.toml",
                  "[particles]\nstart = [[0.01, 0.005]]\n[numerics]\ncells_per_diameter = 10\n"
                  "[run]\nend_time = 0.3\ncheckpoint_every = 0.1\n");
    folder_.write("short.toml", "[run]\nend_time = 0.12\ncheckpoint_every = 0.05\n");
  }
  /// @param before  of the engine's command
  test::JobResult run(const std::string& options, const std::string& before = "") const {
    const std::string scene = BPLBM_SOURCE_DIR "/cases/settling_disc";
    return test::run(test::mpirun({test::kLbm + " " + scene +
                                   "/scene.toml overlay.toml --progress none " + options},
                                  {before + command_for(scene, GetParam())}),
                     folder_.path(), 60.0);
  }
  void expect_ok(const std::string& options) const {
    const test::JobResult job = run(options);
    ASSERT_EQ(job.exit_code, 0) << job.output;
  }
  test::TemporaryFolder folder_;
};

// The disc lies on the ground when the last checkpoint is written, so contacts must be kept too.
TEST_P(EngineRestart, GoesOnToTheBit) {
  expect_ok("--out whole");
  expect_ok("--out parts --until 0.25");
  expect_ok("--out parts --restart");
  EXPECT_EQ(test::read_file(folder_.path() + "/parts/probes.csv"),
            test::read_file(folder_.path() + "/whole/probes.csv"));
}

TEST_P(EngineRestart, ADamagedPartEndsBoth) {
  expect_ok("short.toml --out out --until 0.06");
  for (const auto& entry : std::filesystem::directory_iterator(folder_.path() + "/out"))
    if (entry.path().extension() == ".solid")
      folder_.write("out/" + entry.path().filename().string(), "garbage");
  const test::JobResult job = run("short.toml --out out --restart");
  EXPECT_FALSE(job.timed_out);
  EXPECT_EQ(job.exit_code, 2) << job.output;
  EXPECT_NE(job.output.find("is damaged, or another file than the solid wrote"), std::string::npos)
      << job.output;
}
// LAMMPS and LIGGGHTS do not look whether their writes succeed.
TEST_P(EngineRestart, AFullDiskOfTheSolidLeavesTheCheckpointBefore) {
  expect_ok("short.toml --out whole");
  expect_ok("short.toml --out parts --until 0.06");
  const test::JobResult cut = run("short.toml --out parts --restart",
                                  "sh " BPLBM_SOURCE_DIR "/tests/support/short_of_disk.sh 0 ");
  EXPECT_EQ(cut.exit_code, 1) << cut.output;
  EXPECT_NE(cut.output.find("lbm | error | the solid program stopped: "), std::string::npos)
      << cut.output;
  EXPECT_NE(cut.output.find("checkpoint.240.solid"), std::string::npos) << cut.output;
  expect_ok("short.toml --out parts --restart");
  EXPECT_EQ(test::read_file(folder_.path() + "/parts/probes.csv"),
            test::read_file(folder_.path() + "/whole/probes.csv"));
}
INSTANTIATE_TEST_SUITE_P(All, EngineRestart,
                         testing::Values("liggghts", "lammps", "reference", "python", "yade"),
                         [](const auto& info) { return std::string(info.param); });

}  // namespace
