// SPDX-License-Identifier: GPL-2.0-or-later
/// A recorded settling disc, replayed to each program alone; and a recording that a kill cut off.
#include <gtest/gtest.h>

#include "tests/support/coupled_job.h"

namespace {

using test::kLbm;
using test::kLiggghts;
using test::kReplay;
using test::mpirun;

class ReplayTest : public testing::Test {
 protected:
  void SetUp() override {
    const auto job = scene_.run("--record trace.h5");
    ASSERT_EQ(job.exit_code, 0) << job.output;
  }
  test::JobResult job(const std::string& first, const test::Program& second) const {
    return test::run(mpirun({first}, second), scene_.folder(), 60.0);
  }
  void expect_identical(const test::JobResult& result) const {
    EXPECT_FALSE(result.timed_out) << result.output;
    EXPECT_EQ(result.exit_code, 0) << result.output;
    EXPECT_NE(result.output.find("identical, bit for bit"), std::string::npos) << result.output;
  }
  test::SettlingDisc scene_;
};

TEST_F(ReplayTest, TheFluidAloneGivesTheRecordedLoadsBitForBit) {
  expect_identical(job(kLbm, {kReplay + " --as solid trace.h5"}));
}

TEST_F(ReplayTest, AlsoFacingMoreRanksThanWereRecorded) {
  expect_identical(job(kLbm, {kReplay + " --as solid trace.h5", 2}));
}

TEST_F(ReplayTest, TheSolidAloneGivesTheRecordedStatesBitForBit) {
  expect_identical(job(kReplay + " --as fluid trace.h5", {kLiggghts + " -screen none"}));
}

TEST_F(ReplayTest, ARecordingOfTheSolidReplaysAsWell) {
  scene_.change_script("every ${substeps}", "every ${substeps} record solid.h5");
  const auto recording = scene_.run();
  ASSERT_EQ(recording.exit_code, 0) << recording.output;
  expect_identical(job(kLbm, {kReplay + " --as solid solid.h5"}));
  const auto diff = test::run(test::kBin + "/trace diff trace.h5 solid.h5", scene_.folder(), 50.0);
  EXPECT_EQ(diff.exit_code, 0) << diff.output;  // both sides saw the same exchange
}

TEST_F(ReplayTest, AnotherFluidIsNoticedWithTheFirstDifference) {
  scene_.change_scene("\"layered_resistance\"", "\"noble_torczynski\"");
  const auto result = job(kLbm, {kReplay + " --as solid trace.h5"});
  EXPECT_EQ(result.exit_code, 1) << result.output;
  EXPECT_NE(result.output.find("first difference at interval 1, particle 1, force[1]"),
            std::string::npos)
      << result.output;
}

TEST_F(ReplayTest, InfoAndDiffSpeak) {
  const auto info = test::run(test::kBin + "/trace info trace.h5", scene_.folder(), 50.0);
  EXPECT_EQ(info.exit_code, 0);
  for (const char* word :
       {"recorded by the fluid program", "1 … 1 particles", "ending    complete"})
    EXPECT_NE(info.output.find(word), std::string::npos) << info.output;
  scene_.change_scene("\"layered_resistance\"", "\"noble_torczynski\"");
  ASSERT_EQ(scene_.run("--record other.h5").exit_code, 0);
  const auto diff = test::run(test::kBin + "/trace diff trace.h5 other.h5", scene_.folder(), 50.0);
  EXPECT_EQ(diff.exit_code, 1) << diff.output;
  EXPECT_NE(diff.output.find("first difference at interval"), std::string::npos) << diff.output;
}

TEST(CutOffRecording, IsReadableAndReplaysToWhereItEnds) {
  test::SettlingDisc scene;
  scene.change_scene("end_time = 0.04", "end_time = 60.0");
  const std::string job =
      test::mpirun({kLbm + " --record cut.h5 --progress none"}, {kLiggghts + " -screen none"});
  const auto killed =
      test::run("(" + job + ") & job=$!; until [ -s out/probes.csv ]; do sleep 0.1; done; " +
                    "sleep 2; pkill -KILL -x -P $job lbm; wait $job",
                scene.folder(), 50.0);
  EXPECT_FALSE(killed.timed_out);
  const auto info = test::run(test::kBin + "/trace info cut.h5", scene.folder(), 50.0);
  EXPECT_EQ(info.exit_code, 0) << info.output << killed.output;
  EXPECT_NE(info.output.find("cut off"), std::string::npos) << info.output;
  const auto result =
      test::run(test::mpirun({kLbm}, {kReplay + " --as solid cut.h5"}), scene.folder(), 60.0);
  EXPECT_EQ(result.exit_code, 0) << result.output;
  EXPECT_NE(result.output.find("the recording ends here"), std::string::npos) << result.output;
}

}  // namespace
