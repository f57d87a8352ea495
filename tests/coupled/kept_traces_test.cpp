// SPDX-License-Identifier: GPL-2.0-or-later
/// Recordings of scenes, kept in tests/traces, replayed to each program alone.
#include <gtest/gtest.h>

#include "tests/support/coupled_job.h"

namespace {

using test::mpirun;

class KeptTrace : public testing::TestWithParam<const char*> {
 protected:
  std::string trace() const {
    return BPLBM_SOURCE_DIR "/tests/traces/" + std::string(GetParam()) + ".h5";
  }
  std::string scene() const { return BPLBM_SOURCE_DIR "/cases/" + std::string(GetParam()); }
  void expect_alike(const test::JobResult& job) const {
    EXPECT_FALSE(job.timed_out) << job.output;
    EXPECT_EQ(job.exit_code, 0) << job.output;
  }
  // Round-off of another machine or compiler, amplified over some tens of steps.
  const std::string kReplay = test::kReplay + " --tolerance 1e-9 --as ";
  const test::TemporaryFolder folder_;
};

TEST_P(KeptTrace, TheFluidGivesItsLoads) {
  expect_alike(test::run(mpirun({test::kLbm + " " + scene() + "/scene.toml --progress none"},
                                {kReplay + "solid " + trace()}),
                         folder_.path(), 60.0));
}

TEST_P(KeptTrace, TheSolidGivesItsStates) {
  expect_alike(test::run(
      mpirun({kReplay + "fluid " + trace()},
             {test::kLiggghts + " -log none -screen none -in " + scene() + "/in.liggghts"}),
      folder_.path(), 60.0));
}

INSTANTIATE_TEST_SUITE_P(Scenes, KeptTrace,
                         testing::Values("settling_disc", "disc_migration",
                                         "drafting_kissing_tumbling"),
                         [](const auto& info) { return std::string(info.param); });

}  // namespace
