// SPDX-License-Identifier: MIT
#include "protocol/program/solid_parts.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>

#include "protocol/program/file_catcher.h"
#include "protocol/wire/errors.h"
#include "tests/support/job.h"

namespace {

using namespace protocol;

class SolidPartsTest : public testing::Test {
 protected:
  static void write(SolidParts& parts, std::int64_t interval) {
    parts.keep(interval, std::as_bytes(std::span(kText)));
  }
  std::vector<std::string> files() const {
    std::vector<std::string> names;
    for (const auto& entry : std::filesystem::directory_iterator(folder_.path()))
      names.push_back(entry.path().filename());
    std::sort(names.begin(), names.end());
    return names;
  }
  static constexpr std::string_view kText = "states";
  using Names = std::vector<std::string>;
  test::TemporaryFolder folder_;
};

// Until the fluid has its part of the last one, the pair before it and the one before that matter.
TEST_F(SolidPartsTest, KeepsTheLastThree) {
  SolidParts parts(folder_.path() + "/checkpoint");
  for (const int interval : {3, 6, 9, 12}) write(parts, interval);
  EXPECT_EQ(files(), (Names{"checkpoint.12.solid", "checkpoint.6.solid", "checkpoint.9.solid"}));
  EXPECT_EQ(test::read_file(parts.name(9)), kText);
}

// A run that went on from 6 comes to 8: 9 was damaged, say, and will not be gone on from.
TEST_F(SolidPartsTest, OfARunThatWentOnKeepsThoseBeforeIt) {
  Hello fluid;
  fluid.first_interval = 6;
  for (const char* name : {"checkpoint.1.solid", "checkpoint.3.solid", "checkpoint.6.solid",
                           "checkpoint.9.solid", "checkpoint.9.solid.mine", "notes.txt"})
    folder_.write(name, "states");
  fluid.variables = {{"checkpoint", folder_.path() + "/checkpoint"}};
  SolidParts parts = SolidParts::of(fluid);
  write(parts, 8);
  EXPECT_EQ(files(), (Names{"checkpoint.3.solid", "checkpoint.6.solid", "checkpoint.8.solid",
                            "checkpoint.9.solid.mine", "notes.txt"}));
}

TEST_F(SolidPartsTest, OfAFaultStandBesideThem) {
  SolidParts parts(folder_.path() + "/checkpoint");
  write(parts, 3);
  SolidParts fault = parts.beside("fault");
  write(fault, 4);
  EXPECT_EQ(files(), (Names{"checkpoint.3.solid", "fault.4.solid"}));
}

TEST_F(SolidPartsTest, SaysWhichFileCannotBeWritten) {
  SolidParts parts(folder_.path() + "/nowhere/checkpoint");
  try {
    write(parts, 3);
    FAIL() << "no error";
  } catch (const ProgramError& error) {
    EXPECT_NE(std::string(error.what()).find("nowhere/checkpoint.3.solid cannot be written"),
              std::string::npos)
        << error.what();
  }
}

TEST(FileCatcher, HoldsWhatWasWrittenToItsName) {
  std::string text;
  for (int i = 0; i < 100000; ++i) text += std::to_string(i) + '\n';  // ten times what a pipe holds
  FileCatcher file(".7");
  EXPECT_TRUE(file.path().ends_with(".7"));
  {
    std::FILE* out = std::fopen(file.path().c_str(), "wb");
    ASSERT_NE(out, nullptr);
    std::fwrite(text.data(), 1, text.size(), out);
    std::fclose(out);
  }
  const Bytes bytes = file.take();
  EXPECT_EQ(std::string(reinterpret_cast<const char*>(bytes.data()), bytes.size()), text);
}

TEST(FileCatcher, LeavesNothingBehindAndWaitsForNobody) {
  std::string path;
  {
    const FileCatcher file;  // never opened
    path = file.path();
    EXPECT_TRUE(std::filesystem::exists(path));
  }
  EXPECT_FALSE(std::filesystem::exists(path));
}

}  // namespace
