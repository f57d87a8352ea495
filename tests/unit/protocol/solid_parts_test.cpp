// SPDX-License-Identifier: MIT
#include "protocol/solid_parts.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>

#include "protocol/errors.h"
#include "tests/support/job.h"

namespace {

using namespace protocol;

class SolidPartsTest : public testing::Test {
 protected:
  void write(SolidParts& parts, std::int64_t interval) const {
    parts.complete(folder_.write("part", "states"), interval);
  }
  std::vector<std::string> files() const {
    std::vector<std::string> names;
    for (const auto& entry : std::filesystem::directory_iterator(folder_.path()))
      names.push_back(entry.path().filename());
    std::sort(names.begin(), names.end());
    return names;
  }
  using Names = std::vector<std::string>;
  test::TemporaryFolder folder_;
};

TEST_F(SolidPartsTest, KeepsTheLastTwo) {
  SolidParts parts(folder_.path() + "/checkpoint");
  for (const int interval : {3, 6, 9}) write(parts, interval);
  EXPECT_EQ(files(), (Names{"checkpoint.6.solid", "checkpoint.9.solid"}));
}

// Until the fluid has its part of the next one, a restarted run may need to begin there again.
TEST_F(SolidPartsTest, KeepsWhatARunWentOnFrom) {
  Hello fluid;
  fluid.first_interval = 6;
  const std::string part = folder_.write("checkpoint.6.solid", "states");
  folder_.write("checkpoint.3.solid", "states");
  folder_.write("notes.txt", "not a checkpoint");
  for (const std::string& file : {part, std::filesystem::relative(part).string()}) {
    fluid.variables = {{"checkpoint", folder_.path() + "/checkpoint"}, {"restart_file", file}};
    SolidParts parts = SolidParts::of(fluid);
    write(parts, 9);
    EXPECT_EQ(files(), (Names{"checkpoint.6.solid", "checkpoint.9.solid", "notes.txt"}));
  }
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
  } catch (const ProtocolError& error) {
    EXPECT_NE(std::string(error.what()).find("nowhere/checkpoint.3.solid cannot be written"),
              std::string::npos)
        << error.what();
  }
}

}  // namespace
