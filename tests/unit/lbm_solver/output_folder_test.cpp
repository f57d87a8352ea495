// SPDX-License-Identifier: GPL-2.0-or-later
/// The folder of all output: nothing but a run's own files is ever removed, and one run at a time
/// writes there.
#include "lbm_solver/io/output_folder.h"

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <filesystem>

#include "lbm_solver/base/errors.h"
#include "tests/support/job.h"

namespace {

using namespace lbm;
namespace fs = std::filesystem;

class OutputFolderTest : public testing::Test {
 protected:
  std::string path(const std::string& name) const { return folder_.path() + "/" + name; }
  void write(const std::string& name, const std::string& text = "x") const {
    fs::create_directories(fs::path(path(name)).parent_path());
    folder_.write(name, text);
  }
  std::string take(const std::string& name, EarlierRun earlier) const {
    return OutputFolder(path(name), "a scene", earlier).set_aside();
  }
  std::string refusal(const std::string& name, EarlierRun earlier = EarlierRun::SetAside) const {
    try {
      take(name, earlier);
    } catch (const InputError& e) {
      return e.what();
    }
    return "accepted";
  }
  void expect_in(const std::string& text, const std::string& word) const {
    EXPECT_NE(text.find(word), std::string::npos) << text;
  }
  test::TemporaryFolder folder_;
};

TEST_F(OutputFolderTest, IsMadeAndMarked) {
  EXPECT_EQ(take("new/out", EarlierRun::SetAside), "");
  expect_in(test::read_file(path("new/out/.bplbm")), "scene a scene\n");
  EXPECT_FALSE(fs::exists(path("new/out/.bplbm.lock")));  // given back
  fs::create_directory(path("empty"));
  EXPECT_EQ(take("empty", EarlierRun::Replace), "");
  EXPECT_EQ(take("empty", EarlierRun::SetAside), "") << "there was no run yet";
}

TEST_F(OutputFolderTest, OfSomebodyElseIsLeftAlone) {
  write("thesis/summary.json");
  for (const EarlierRun earlier : {EarlierRun::SetAside, EarlierRun::Replace})
    expect_in(refusal("thesis", earlier), "is not empty, and no folder of an earlier run");
  EXPECT_TRUE(fs::exists(path("thesis/summary.json")));
  EXPECT_FALSE(fs::exists(path("thesis/.bplbm")));
  write("file");
  expect_in(refusal("file"), "is no folder");
}

TEST_F(OutputFolderTest, AnEarlierRunIsSetAside) {
  for (const std::string result : {"summary.json", "checkpoint.h5", "probes.csv"}) {
    take("out", EarlierRun::SetAside);
    write("out/" + result, result);
  }
  EXPECT_EQ(take("out", EarlierRun::SetAside), fs::canonical(folder_.path()).string() + "/out.3");
  EXPECT_EQ(test::read_file(path("out.1/summary.json")), "summary.json");
  EXPECT_EQ(test::read_file(path("out.2/checkpoint.h5")), "checkpoint.h5");
  EXPECT_EQ(test::read_file(path("out.3/probes.csv")), "probes.csv");
  EXPECT_FALSE(fs::exists(path("out/probes.csv")));
  EXPECT_TRUE(fs::exists(path("out/.bplbm")));
}

TEST_F(OutputFolderTest, OfALinkWhatItPointsAtIsSetAside) {
  take("disk", EarlierRun::SetAside);
  write("disk/summary.json");
  fs::create_directory_symlink(path("disk"), path("out"));
  take("out", EarlierRun::SetAside);
  EXPECT_TRUE(fs::is_symlink(path("out")));
  EXPECT_TRUE(fs::exists(path("disk.1/summary.json")));
  EXPECT_FALSE(fs::exists(path("disk/summary.json")));
}

TEST_F(OutputFolderTest, OnlyItsOwnFilesAreReplaced) {
  take("out", EarlierRun::SetAside);
  write("out/.bplbm", "file field.png\nfile ../outside.txt\nfile ..\nfile folder\n");
  const std::vector<std::string> ours{
      "summary.json",  "probes.csv", "checkpoint.h5", "checkpoint.12.solid",
      "fault.h5.part", "field.png",  "lbm.log",       "study/set-fine/summary.json"};
  const std::vector<std::string> theirs{"thesis.txt", "other.png", "folder/field.png",
                                        "study/mine/summary.json", "../outside.txt"};
  for (const auto& name : ours) write("out/" + name);
  for (const auto& name : theirs) write("out/" + name);
  write("out/study/set-fine/.bplbm");
  EXPECT_EQ(take("out", EarlierRun::Replace), "");
  for (const auto& name : ours) EXPECT_FALSE(fs::exists(path("out/" + name))) << name;
  for (const auto& name : theirs) EXPECT_TRUE(fs::exists(path("out/" + name))) << name;
}

TEST_F(OutputFolderTest, ARunThatGoesOnKeepsEverything) {
  take("out", EarlierRun::SetAside);
  write("out/checkpoint.h5");
  EXPECT_EQ(take("out", EarlierRun::GoOn), "");
  EXPECT_TRUE(fs::exists(path("out/checkpoint.h5")));
}

TEST_F(OutputFolderTest, OneRunAtATime) {
  const auto first = std::make_unique<OutputFolder>(path("out"), "", EarlierRun::SetAside);
  write("out/probes.csv");
  for (const EarlierRun earlier : {EarlierRun::SetAside, EarlierRun::Replace, EarlierRun::GoOn})
    expect_in(refusal("out", earlier),
              "another run writes into it: process " + std::to_string(getpid()) + " on this host");
  EXPECT_TRUE(fs::exists(path("out/probes.csv")));
}

TEST_F(OutputFolderTest, OfAKilledRunIsFree) {
  fs::create_directory(path("out"));
  int ready[2];
  ASSERT_EQ(pipe(ready), 0);
  const pid_t child = fork();
  if (child == 0) {
    const RunLock lock(path("out"));
    [[maybe_unused]] const auto told = ::write(ready[1], "r", 1);
    pause();
  }
  char word = 0;
  ASSERT_EQ(read(ready[0], &word, 1), 1);
  expect_in(refusal("out"), "process " + std::to_string(child));
  kill(child, SIGKILL);
  waitpid(child, nullptr, 0);
  EXPECT_TRUE(fs::exists(path("out/.bplbm.lock")));
  EXPECT_EQ(refusal("out"), "accepted");
  EXPECT_FALSE(fs::exists(path("out/.bplbm.lock")));
}

TEST_F(OutputFolderTest, OfAnotherHostIsRefusedWithTheFileToDelete) {
  take("out", EarlierRun::SetAside);
  write("out/.bplbm.lock", "4711 elsewhere\n");
  const std::string text = refusal("out");
  expect_in(text, "process 4711 on host elsewhere");
  expect_in(text, "delete ");
  expect_in(text, "out/.bplbm.lock");
  EXPECT_EQ(test::read_file(path("out/.bplbm.lock")), "4711 elsewhere\n");
}

}  // namespace
