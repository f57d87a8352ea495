// SPDX-License-Identifier: GPL-2.0-or-later
#include "liggghts_coupling/host/script_names.h"

#include <gtest/gtest.h>

#include "tests/support/job.h"

namespace {

using Texts = std::vector<std::string>;

TEST(ScriptNames, NamesWhatNothingDefinesOnceAndWithItsLine) {
  const test::TemporaryFolder folder;
  const std::string inner = folder.write("inner.txt", "run ${steps}\nprint ${lost_there}\n");
  const std::string script =
      folder.write("in.script",
                   "# ${in_a_comment}\nunits ${offered}\nvariable mass equal 2*${stiffness}\n"
                   "print ${mass} ${stiffness}\ninclude ${folder}/inner.txt\n"
                   "include ${lost_folder}/more.txt\nif 1 then \"variable steps equal 3\"\n");
  const auto value = [&](const std::string& name) -> std::optional<std::string> {
    if (name == "folder") return folder.path();
    if (name == "offered") return "si";
    return std::nullopt;
  };
  EXPECT_EQ(dem::undefined_names(script, value),
            (Texts{"${stiffness} (" + script + ":3)", "${lost_there} (" + inner + ":2)",
                   "${lost_folder} (" + script + ":6)"}));
}

TEST(ScriptNames, AFileThatIncludesItselfComesToAnEnd) {
  const test::TemporaryFolder folder;
  const std::string script = folder.path() + "/in.script";
  folder.write("in.script", "include " + script + "\nprint ${lost}\n");
  const auto nothing = [](const std::string&) -> std::optional<std::string> { return {}; };
  EXPECT_EQ(dem::undefined_names(script, nothing).size(), 1U);
  EXPECT_TRUE(dem::undefined_names(folder.path() + "/none", nothing).empty());
}

}  // namespace
