// SPDX-License-Identifier: GPL-2.0-or-later
/// A fluid alone, killed at any moment, goes on from its last checkpoint to the bit.
#include <gtest/gtest.h>

#include <filesystem>

#include "tests/support/coupled_job.h"

namespace {

using test::kLbm;
using test::replaced;

/// A cylinder in a channel with an oscillating inlet and an outflow, so that every kind of state
/// counts.
std::string scene(const std::string& checkpoint) {
  std::string text = test::read_file(BPLBM_SOURCE_DIR "/cases/cylinder_flow/scene.toml");
  text = replaced(text, "cell = 0.005 ", "cell = 0.01 ");
  text = replaced(text, "ramp = 1.0 ", "frequency = 2.0\nramp = 1.0 ");
  text = replaced(text, "end_time = 60.0             # s\nsteady_below = 1e-6",
                  "end_time = 20.0\n" + checkpoint);
  return replaced(text, "fields_every = 60.0", "fields_every = 3.0");
}

class RestartTest : public testing::Test {
 protected:
  test::JobResult run(const std::string& options) const {
    return test::run(kRoot + kLbm + " --progress none " + options, folder_.path(), 60.0);
  }
  /// Kills a run some moments after there is a checkpoint in the folder.
  void kill_after_checkpoint(const std::string& options, const std::string& seconds) const {
    const auto job =
        test::run(kRoot + "(" + kLbm + " --progress none " + options +
                      ") & job=$!; until [ -e cut/checkpoint.h5 ]; do sleep 0.02; done; sleep " +
                      seconds + "; pkill -KILL -P $job; kill -KILL $job; wait",
                  folder_.path(), 60.0);
    EXPECT_FALSE(job.timed_out) << job.output;
  }
  const std::string kRoot = "export OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1; ";
  std::string file(const std::string& name) const {
    return test::read_file(folder_.path() + "/" + name);
  }
  test::TemporaryFolder folder_;
};

TEST_F(RestartTest, KilledAtSeveralMomentsItEndsLikeARunThatWasNot) {
  folder_.write("scene.toml", scene("checkpoint_every = 0.5"));
  ASSERT_EQ(run("--out whole").exit_code, 0);
  kill_after_checkpoint("--out cut", "0.05");
  for (const char* moment : {"0.11", "0.23", "0.17"})
    kill_after_checkpoint("--out cut --restart", moment);
  const auto last = run("--out cut --restart");
  ASSERT_EQ(last.exit_code, 0) << last.output;
  EXPECT_NE(last.output.find("goes on from"), std::string::npos);
  EXPECT_EQ(file("cut/points.csv"), file("whole/points.csv"));
  EXPECT_EQ(file("cut/obstacles.csv"), file("whole/obstacles.csv"));
  EXPECT_GT(file("whole/points.csv").size(), 1000U);
  const auto frames = test::run("h5diff -v whole/fields.h5 cut/fields.h5 /frame000006/velocity",
                                folder_.path(), 50.0);
  EXPECT_EQ(frames.exit_code, 0) << frames.output;  // 2 where one of them lacks it
  EXPECT_NE(frames.output.find("0 differences found"), std::string::npos) << frames.output;
}

TEST_F(RestartTest, ALineThatAKillHasCutOffIsLeftOut) {
  folder_.write("scene.toml", scene("checkpoint_every = 0.5"));
  ASSERT_EQ(run("--out whole").exit_code, 0);
  ASSERT_EQ(run("--out cut --until 2").exit_code, 0);
  const std::string cut = file("cut/points.csv") + "0.", name = folder_.path() + "/cut/points.csv";
  folder_.write("cut/points.csv", cut);
  ASSERT_EQ(run("--out cut --restart").exit_code, 0);
  EXPECT_EQ(file("cut/points.csv"), file("whole/points.csv"));
  EXPECT_FALSE(std::filesystem::exists(name + ".part"));
}

TEST_F(RestartTest, SaysWhatIsWrong) {
  folder_.write("scene.toml", scene("checkpoint_every = 0.5"));
  auto job = run("--out nothing --restart");
  EXPECT_EQ(job.exit_code, 2);
  EXPECT_NE(job.output.find("nothing/checkpoint.h5: no checkpoint to restart from"),
            std::string::npos)
      << job.output;
  ASSERT_EQ(run("--out some --until 2").exit_code, 0);
  folder_.write("scene.toml",
                replaced(scene("checkpoint_every = 0.5"), "cell = 0.01 ", "cell = 0.005 "));
  job = run("--out some --restart");
  EXPECT_EQ(job.exit_code, 2);
  EXPECT_NE(job.output.find("numerics.cell: 0.01 then, 0.005 now"), std::string::npos)
      << job.output;
}

}  // namespace
