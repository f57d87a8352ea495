// SPDX-License-Identifier: GPL-2.0-or-later
/// What a run does with its folder, its end and its environment: nothing is lost, nothing is
/// accepted that means nothing.
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <filesystem>
#include <sstream>

#include "tests/support/coupled_job.h"

namespace {

using test::JobResult;
using test::kLbm;
namespace fs = std::filesystem;

/// A small fluid alone that writes a table.
const std::string kScene = R"(
[box]
size = [0.1, 0.1]
sides_x = "periodic"
[fluid]
density = 1000.0
kinematic_viscosity = 1e-4
body_force = [0.001, 0.0]
velocity_scale = 0.01
[numerics]
cell = 0.005
[run]
end_time = 10.0
checkpoint_every = 0.5
[output]
points = [[0.05, 0.05]]
probe_every = 0.1
)";

class OutputTest : public testing::Test {
 protected:
  OutputTest() { folder_.write("scene.toml", kScene); }
  JobResult run(const std::string& options, const std::string& before = "") const {
    return test::run(kRoot + before + kLbm + " --progress none " + options, folder_.path(), 60.0);
  }
  void expect_ok(const JobResult& job) const { ASSERT_EQ(job.exit_code, 0) << job.output; }
  void expect_end(const JobResult& job, int code, const std::vector<std::string>& words) const {
    EXPECT_FALSE(job.timed_out) << "hangs: " << job.output;
    EXPECT_EQ(job.exit_code, code) << job.output;
    for (const auto& word : words)
      EXPECT_NE(job.output.find(word), std::string::npos) << word << " not in:\n" << job.output;
  }
  std::string path(const std::string& name) const { return folder_.path() + "/" + name; }
  double last_time(const std::string& table) const {
    std::istringstream lines(test::read_file(path(table)));
    std::string line, last;
    while (std::getline(lines, line)) last = line;
    return std::atof(last.c_str());
  }
  const std::string kRoot = "export OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1; ";
  test::TemporaryFolder folder_;
};

TEST_F(OutputTest, AnEarlierRunIsKeptUnlessItIsToBeReplaced) {
  expect_ok(run("--until 1"));
  const std::string first = test::read_file(path("out/summary.json"));
  const JobResult second = run("--until 2");
  expect_end(second, 0, {"the earlier run of this folder is now "});
  EXPECT_EQ(test::read_file(path("out.1/summary.json")), first);
  EXPECT_TRUE(fs::exists(path("out.1/checkpoint.h5")));
  EXPECT_NE(test::read_file(path("out/summary.json")), first);
  folder_.write("out/thesis.txt", "years of work");
  expect_ok(run("--until 1 --force"));
  EXPECT_FALSE(fs::exists(path("out.2")));
  expect_end(run("--restart --force"), 2, {"lbm | error | ", "--force"});
  EXPECT_TRUE(fs::exists(path("out/thesis.txt")));
}

TEST_F(OutputTest, AFlowThatIsNotFoundIsSaid) {
  const std::string ends = R"(
[[boundary]]
side = "left"
kind = "pressure"
flow_rate = 1e-4
[[boundary]]
side = "right"
kind = "pressure"
)";
  std::string open = test::replaced(kScene, "sides_x = \"periodic\"\n", "") + ends;
  open = test::replaced(open, "body_force = [0.001, 0.0]\n", "");
  open = test::replaced(open, "end_time = 10.0", "end_time = 60.0");
  open = test::replaced(open, "checkpoint_every = 0.5", "checkpoint_every = 10.0");
  folder_.write("open.toml", open);
  const JobResult found = run("open.toml --out open");
  expect_ok(found);
  EXPECT_EQ(found.output.find("wanted is"), std::string::npos) << found.output;
  EXPECT_NE(test::read_file(path("open/summary.json")).find("held_pressure"), std::string::npos);
  folder_.write("blocked.toml", open + "[[obstacle]]\nfrom = [0.04, 0.0]\nto = [0.06, 0.1]\n");
  expect_end(run("blocked.toml --out blocked"), 0,
             {"hint         the flow at the end is", "wanted is 0.0001", "something blocks it"});
}

TEST_F(OutputTest, AFolderOfSomebodyElseIsRefused) {
  expect_end(run("--out ."), 2, {"lbm | error | .: is not empty, and no folder of an earlier run"});
  EXPECT_FALSE(fs::exists(path("lbm.log")));
}

TEST_F(OutputTest, TwoRunsAtOnceAreRefused) {
  const std::string busy = "(" + kLbm +
                           " --progress none > first.txt 2>&1) & first=$!; "
                           "until [ -s out/points.csv ]; do sleep 0.02; done; ";
  folder_.write("scene.toml", test::replaced(kScene, "end_time = 10.0", "end_time = 1e5"));
  const JobResult job =
      test::run(kRoot + busy + kLbm + " --force; code=$?; pkill -KILL -P $first; wait; exit $code",
                folder_.path(), 60.0);
  expect_end(job, 2, {"lbm | error | ", "another run writes into it: process "});
  EXPECT_TRUE(fs::exists(path("out/points.csv")));
  expect_ok(run("--until 1"));  // the one that was killed holds nothing
}

TEST_F(OutputTest, ATableThatIsDeletedMeanwhileIsAnError) {
  folder_.write("scene.toml", test::replaced(kScene, "end_time = 10.0", "end_time = 1e5"));
  const JobResult job =
      test::run(kRoot + "(" + kLbm +
                    " --progress none) & job=$!; until [ -s out/points.csv ]; do sleep "
                    "0.02; done; rm out/points.csv; wait $job",
                folder_.path(), 50.0);
  expect_end(job, 1, {"points.csv was deleted while the run was writing it"});
}

TEST_F(OutputTest, AnEndThatIsNoTimeOfTheSceneIsRefused) {
  for (const std::string until : {"nan", "1e300", "inf", "-1", "0", "10.1"}) {
    expect_end(run("--until " + until), 2, {"lbm | error | ", "--until"});
    EXPECT_FALSE(fs::exists(path("out"))) << until;
  }
  expect_ok(run("--until 10"));
}

TEST_F(OutputTest, ARestartMayHaveALaterEnd) {
  folder_.write("scene.toml", test::replaced(kScene, "end_time = 10.0", "end_time = 1.37"));
  expect_ok(run(""));
  folder_.write("scene.toml", kScene);
  const JobResult job = run("--restart");
  expect_end(job, 0, {"goes on from"});
  EXPECT_NEAR(last_time("out/points.csv"), 10.0, 0.04);  // an interval is 0.039 s
  folder_.write("scene.toml",
                test::replaced(kScene, "velocity_scale = 0.01", "velocity_scale = 0.02"));
  expect_end(run("--restart --until 10"), 2,
             {"of another scene", "fluid.velocity_scale: 0.01 then, 0.02 now"});
}

TEST_F(OutputTest, ACheckpointThatIsNoFileIsRefused) {
  expect_ok(run("--until 1"));
  fs::remove(path("out/checkpoint.h5"));
  fs::remove(path("out/checkpoint.before.h5"));  // else that one would be used
  ASSERT_EQ(mkfifo(path("out/checkpoint.h5").c_str(), 0600), 0);
  expect_end(run("--restart"), 2, {"checkpoint.h5: is no regular file (a pipe or a device?)"});
}

TEST_F(OutputTest, ThreadsOfTheEnvironmentAreANumber) {
  for (const std::string threads : {"100000", "-1", "0", "2x", "many"}) {
    expect_end(run("--until 1", "OMP_NUM_THREADS=" + threads + " "), 2,
               {"lbm | error | the environment variable OMP_NUM_THREADS = '" + threads + "'"});
    expect_end(run("check scene.toml", "OMP_NUM_THREADS=" + threads + " "), 2, {"OMP_NUM_THREADS"});
  }
  expect_ok(run("--until 1", "OMP_NUM_THREADS=2,1 "));
}

TEST_F(OutputTest, TracesAreRegularFilesThatHoldWhatTheySay) {
  ASSERT_EQ(mkfifo(path("pipe.h5").c_str(), 0600), 0);
  for (const std::string command : {"info pipe.h5", "diff pipe.h5 pipe.h5", "plot /dev/zero",
                                    "cut pipe.h5 some.h5 --intervals 1"})
    expect_end(test::run(test::kBin + "/trace " + command, folder_.path(), 10.0), 2,
               {"trace | error | cannot open ", "is no regular file (a pipe or a device?)"});
}

TEST(Recording, TakesThePlaceOfNoOtherFile) {
  const test::SettlingDisc scene;
  ASSERT_EQ(scene.run("--record one.h5").exit_code, 0);
  for (const std::string name : {"scene.toml", "out.1/fields.h5"}) {
    const auto job = scene.run("--record " + name);
    EXPECT_EQ(job.exit_code, 1) << job.output;
    EXPECT_NE(job.output.find(name + " is there and no recording"), std::string::npos)
        << job.output;
  }
  EXPECT_EQ(test::read_file(scene.folder() + "/scene.toml"), scene.scene());
  EXPECT_EQ(scene.run("--record one.h5").exit_code, 0);
  const auto cut =
      test::run(test::kBin + "/trace cut one.h5 ./one.h5 --intervals 1", scene.folder(), 10.0);
  EXPECT_EQ(cut.exit_code, 2);
  EXPECT_NE(cut.output.find("is the recording itself"), std::string::npos) << cut.output;
}

TEST(CommandLine, NumbersAreFinite) {
  for (const std::string words :
       {"replay --as solid t.h5 --timeout nan", "replay --as solid t.h5 --timeout 0",
        "replay --as solid t.h5 --tolerance nan", "replay --as solid t.h5 --tolerance 1x"}) {
    const auto job = test::run(test::kBin + "/" + words, ".", 10.0);
    EXPECT_EQ(job.exit_code, 2) << job.output;
    EXPECT_NE(job.output.find("' is not a number "), std::string::npos) << job.output;
  }
}

// The plain command with another folder: what the script writes goes there too.
TEST(OutputFolderOfTheFluid, IsTheOneOfTheScript) {
  test::SettlingDisc scene;
  scene.change_scene("end_time = 0.04", "end_time = 0.002");
  scene.set_script("print \"told\" file ${out_folder}/told.txt\n" + scene.script());
  const JobResult job = scene.run("--out elsewhere scene.toml");
  EXPECT_EQ(job.exit_code, 0) << job.output;
  EXPECT_EQ(test::read_file(scene.folder() + "/elsewhere/told.txt"), "told\n");
  EXPECT_FALSE(fs::exists(scene.folder() + "/out"));
}

}  // namespace
