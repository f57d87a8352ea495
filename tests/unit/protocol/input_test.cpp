// SPDX-License-Identifier: MIT
/// Files and numbers that a user gives: what is no file or no number is refused, and nothing waits.
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <cstdlib>
#include <limits>

#include "protocol/program/input_file.h"
#include "protocol/wire/numbers.h"
#include "tests/support/job.h"

namespace {

using namespace protocol;

TEST(InputFile, IsRegularAndOfBoundedSize) {
  const test::TemporaryFolder folder;
  const std::string file = folder.write("file", "0123456789"), pipe = folder.path() + "/pipe";
  ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
  EXPECT_EQ(why_unreadable(file), "");
  EXPECT_EQ(why_unreadable(file, 10), "");
  EXPECT_NE(why_unreadable(file, 9).find("more than"), std::string::npos);
  EXPECT_NE(why_unreadable(pipe).find("a pipe or a device"), std::string::npos);
  EXPECT_NE(why_unreadable("/dev/zero").find("a pipe or a device"), std::string::npos);
  EXPECT_EQ(why_unreadable(folder.path()), "is a folder, not a file");
  EXPECT_EQ(why_unreadable(folder.path() + "/none"), "no such file");
}

TEST(Number, IsTheWholeText) {
  EXPECT_EQ(to_number<int>("10"), 10);
  EXPECT_EQ(to_number<int>("+10"), 10);
  EXPECT_EQ(to_number<double>("-1.5e-3"), -1.5e-3);
  EXPECT_EQ(to_number<double>("1"), 1.0);
  for (const char* text : {"", "10x", "x", "1.5", "++1", "+-1", " 1", "1 ", "99999999999", "1e3"})
    EXPECT_FALSE(to_number<int>(text)) << text;
  for (const char* text : {"", "1.2.3", "3s", "nan", "inf", "1e999", "0x10", "1,5"})
    EXPECT_FALSE(to_number<double>(text)) << text;
}

TEST(Environment, ATimeIsANumberOfSeconds) {
  constexpr const char* name = "BPLBM_TEST_SECONDS";
  unsetenv(name);
  EXPECT_EQ(seconds_from_environment(name, 0.6), 0.6);
  setenv(name, "2.5", 1);
  EXPECT_EQ(seconds_from_environment(name, 0.6), 2.5);
  for (const char* text : {"2.5s", "-1", "nan", ""}) {
    setenv(name, text, 1);
    try {
      seconds_from_environment(name, 0.6);
      ADD_FAILURE() << "accepted: " << text;
    } catch (const ProgramError& e) {
      EXPECT_EQ(e.exit_code(), kBadInput);
      EXPECT_NE(std::string(e.what()).find(name), std::string::npos);
    }
  }
  unsetenv(name);
}

}  // namespace
