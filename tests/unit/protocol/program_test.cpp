// SPDX-License-Identifier: MIT
#include "protocol/program/program.h"

#include <gtest/gtest.h>
#include <unistd.h>

namespace {

using namespace protocol;

TEST(DeadlineDeathTest, SaysTheReasonAndEndsWithItsCode) {
  const ProgramError error("the box is on fire", kBadInput);
  EXPECT_EXIT(
      {
        const Deadline deadline(error, "lbm", 1);
        sleep(10);
      },
      testing::ExitedWithCode(kBadInput), "lbm \\| error \\| the box is on fire");
}

TEST(Deadline, IsOffOnceTheWorkIsDone) {
  { const Deadline deadline(ProgramError("nothing"), "lbm", 1); }
  EXPECT_EQ(sleep(2), 0U);  // no signal comes
}

}  // namespace
