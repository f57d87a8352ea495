// SPDX-License-Identifier: GPL-2.0-or-later
#include "liggghts_coupling/host/screen_ear.h"

#include <gtest/gtest.h>

#include "tests/support/job.h"

namespace {

TEST(ScreenEar, PassesOnWhatItHearsAndKeepsTheLastError) {
  const test::TemporaryFolder folder;
  const std::string path = folder.path() + "/screen.txt";
  std::FILE* screen = std::fopen(path.c_str(), "w");
  dem::ScreenEar ear;
  std::FILE* stream = ear.listen(screen);
  ASSERT_NE(stream, nullptr);
  const std::string text = "Step Atoms\n  ERROR is no first word here\nERROR: no (pair.cpp:7)\nat";
  std::fputs(text.c_str(), stream);
  std::fflush(stream);
  EXPECT_EQ(ear.last_error(), "ERROR: no (pair.cpp:7)");
  std::fputs(" the end\nERROR on proc 3: later (../src/a.cpp:12)\n", stream);
  std::fclose(stream);
  std::fclose(screen);
  EXPECT_EQ(ear.last_error(), "ERROR on proc 3: later (../src/a.cpp:12)");
  EXPECT_EQ(test::read_file(path), text + " the end\nERROR on proc 3: later (../src/a.cpp:12)\n");
}

TEST(ScreenEar, NeedsNoScreen) {
  dem::ScreenEar ear;
  std::FILE* stream = ear.listen(nullptr);
  std::fputs("ERROR: alone\n", stream);
  std::fclose(stream);
  EXPECT_EQ(ear.last_error(), "ERROR: alone");
}

// As LIGGGHTS writes them: the place in the source behind the text, whose last line may be empty.
TEST(ScreenEar, KeepsAllLinesOfAnError) {
  dem::ScreenEar ear;
  std::FILE* stream = ear.listen(nullptr);
  std::fputs(
      "ERROR: Unable to calculate region volume. Possible sources of error: \n"
      "   (a) region volume is too small\n   (b) particles are too large\n (../src/a.cpp:7)\n"
      "Step Atoms\n",
      stream);
  std::fflush(stream);
  EXPECT_EQ(dem::without_source(ear.last_error()),
            "ERROR: Unable to calculate region volume. Possible sources of error: (a) region "
            "volume is too small (b) particles are too large");
  std::fputs("ERROR on proc 1: one (a.cpp:1)\nno more\n", stream);
  std::fclose(stream);
  EXPECT_EQ(ear.last_error(), "ERROR on proc 1: one (a.cpp:1)");
}

TEST(ScreenEar, TellsOfEachWarning) {
  dem::ScreenEar ear;
  std::vector<std::string> told;
  ear.tell_warnings([&](const std::string& line) { told.push_back(line); });
  std::FILE* stream = ear.listen(nullptr);
  std::fputs("WARNING: one (a.cpp:1)\n no WARNING\nWARNING: two\nWARNING: not ended", stream);
  std::fclose(stream);
  EXPECT_EQ(told, (std::vector<std::string>{"WARNING: one (a.cpp:1)", "WARNING: two"}));
}

TEST(ScreenEar, AnErrorIsToldWithoutItsSource) {
  EXPECT_EQ(dem::without_source("ERROR: Invalid pair style (/build/liggghts-1/src/force.cpp:246)"),
            "ERROR: Invalid pair style");
  EXPECT_EQ(dem::without_source("ERROR: fix x (every 3) is odd (../fix_x.cpp:1)"),
            "ERROR: fix x (every 3) is odd");
  EXPECT_EQ(dem::without_source("ERROR: types (1 and 2)"), "ERROR: types (1 and 2)");
}

TEST(AdviceFor, SaysWhatToDoAboutMeshes) {
  EXPECT_NE(dem::advice_for("Mesh (id a): All 12 mesh elements have been lost / left the domain.")
                .find("${mesh1}"),
            std::string::npos);
  EXPECT_NE(dem::advice_for("ERROR on proc 0: assertion failed").find("a larger depth"),
            std::string::npos);
  EXPECT_NE(dem::advice_for("Fix mesh: Bad mesh, try re-running with 'heal auto_remove_duplicates'")
                .find("one and the same"),
            std::string::npos);
  EXPECT_NE(dem::advice_for("ERROR: Fix mesh: Bad mesh, cannot continue.").find("long and thin"),
            std::string::npos);
  EXPECT_NE(
      dem::advice_for("ERROR on proc 0: Internal error").find("its centre lay in the surface"),
      std::string::npos);
  EXPECT_EQ(dem::advice_for("Illegal fix command"), "");
}

}  // namespace
