// SPDX-License-Identifier: GPL-2.0-or-later
/// The channel tests' conversation over a real MPI job, with any order and number of ranks.
#include <gtest/gtest.h>

#include "tests/support/coupled_job.h"

namespace {

using test::Program;

void expect_complete(const Program& first, const Program& second) {
  const auto job = test::run(test::mpirun(first, second), "/tmp", 60.0);
  EXPECT_FALSE(job.timed_out) << job.output;
  EXPECT_EQ(job.exit_code, 0) << job.output;
  int complete = 0;
  for (std::size_t at = 0; (at = job.output.find("conversation complete", at)) != std::string::npos;
       ++at)
    ++complete;
  EXPECT_EQ(complete, first.ranks + second.ranks) << job.output;
}

TEST(MpiChannel, CarriesTheConversation) {
  const std::string fluid = test::kBin + "/channel_peer fluid",
                    solid = test::kBin + "/channel_peer solid";
  expect_complete({fluid, 1}, {solid, 1});
  expect_complete({solid, 2}, {fluid, 1});  // the other order
  expect_complete({fluid, 1}, {solid, 3});
  expect_complete({fluid, 2}, {solid, 1});
}

}  // namespace
