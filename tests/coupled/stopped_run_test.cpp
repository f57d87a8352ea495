// SPDX-License-Identifier: GPL-2.0-or-later
/// A run that is stopped and goes on equals the run that was not, bit for bit: with bonds that
/// break, contacts, walls with friction and an open side. A damaged checkpoint is refused, and the
/// one before it used; so is one of another scene.
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <random>
#include <sstream>

#include "tests/support/coupled_job.h"

namespace {

namespace fs = std::filesystem;

using test::JobResult;
using test::kLbm;
using test::kLiggghts;

constexpr const char* kScene = BPLBM_SOURCE_DIR "/tests/support/stopped";

struct Ranks {
  int fluid = 1, solid = 1;
};

class StoppedRunTest : public testing::Test {
 protected:
  StoppedRunTest() {
    folder_.write("scene.toml", test::read_file(std::string(kScene) + "/scene.toml"));
    folder_.write("in.liggghts", test::read_file(std::string(kScene) + "/in.liggghts"));
  }
  std::string path(const std::string& name) const { return folder_.path() + "/" + name; }
  std::string file(const std::string& name) const { return test::read_file(path(name)); }
  void change(const std::string& from, const std::string& to) const {
    folder_.write("scene.toml", test::replaced(file("scene.toml"), from, to));
  }
  std::string job(const std::string& out, const std::string& options, Ranks ranks) const {
    return test::mpirun(
        {kLbm + " scene.toml --progress none --out " + out + " " + options, ranks.fluid},
        {kLiggghts + " -in in.liggghts -log none -screen none -var out_folder " + out,
         ranks.solid});
  }
  JobResult run(const std::string& out, const std::string& options = "", Ranks ranks = {}) const {
    const auto start = std::chrono::steady_clock::now();
    const JobResult result = test::run(job(out, options, ranks), folder_.path(), 300.0);
    const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - start;
    if (out == "whole") whole_seconds_ = seconds.count();
    return result;
  }
  void expect_ok(const JobResult& result) const { ASSERT_EQ(result.exit_code, 0) << result.output; }
  void expect_said(const JobResult& result, const std::string& text) const {
    EXPECT_NE(result.output.find(text), std::string::npos) << text << "\nin\n" << result.output;
  }

  /// Everything that a run leaves behind, but for its logs and summary. (Where a signal came late,
  /// its own checkpoint is one of the last.)
  void expect_like_whole(const std::string& out) const {
    std::vector<std::string> names{"probes.csv", "breaks.csv"};
    // a signal after the undisturbed run's last checkpoint leaves a later one, which it has not
    const bool same_last = last_part(out).substr(out.size()) == last_part("whole").substr(5);
    if (same_last) names.emplace_back("checkpoint.h5");
    if (parts(out) == parts("whole")) names.emplace_back("checkpoint.before.h5");
    for (const std::string& name : parts("whole"))
      if (fs::exists(path(out + "/" + name))) names.push_back(name);
    for (const std::string& name : names)
      EXPECT_TRUE(file("whole/" + name) == file(out + "/" + name)) << name;
    if (!same_last) {
      EXPECT_GT(interval_of(last_part(out)), interval_of(last_part("whole")));
    }
    const JobResult fields =
        test::run("h5diff whole/fields.h5 " + out + "/fields.h5", folder_.path(), 60.0);
    EXPECT_EQ(fields.exit_code, 0) << fields.output;
  }
  /// The solid's parts of checkpoints, sorted by name. (Where the fluid was killed, the solid keeps
  /// its last state in fault.INTERVAL.solid; that is no checkpoint.)
  std::vector<std::string> parts(const std::string& out) const {
    std::vector<std::string> names;
    for (const auto& entry : fs::directory_iterator(path(out))) {
      const std::string name = entry.path().filename();
      if (name.starts_with("checkpoint.") && name.ends_with(".solid")) names.push_back(name);
    }
    std::sort(names.begin(), names.end());
    return names;
  }
  /// Of "[folder/]checkpoint.INTERVAL.solid".
  static long interval_of(const std::string& part) {
    return std::stol(part.substr(part.find("checkpoint.") + 11));
  }
  /// The solid's part that belongs to checkpoint.h5, or to the one before.
  std::string last_part(const std::string& out, int before = 0) const {
    std::vector<std::string> names = parts(out);
    std::sort(names.begin(), names.end(),
              [](const auto& a, const auto& b) { return interval_of(a) > interval_of(b); });
    return out + "/" + names.at(before);
  }
  void flip(const std::string& name, std::uint64_t bit) const {
    std::string bytes = file(name);
    bytes[bit / 8 % bytes.size()] = static_cast<char>(bytes[bit / 8 % bytes.size()] ^ 1 << bit % 8);
    std::ofstream(path(name), std::ios::binary) << bytes;
  }

  /// Stops a run again and again at random moments, until one gets to its end.
  /// @param kill  the shell's words that stop it; $job is mpirun
  void stop_often(const std::string& out, int times, unsigned seed, Ranks ranks = {}) const;

  test::TemporaryFolder folder_;
  mutable double whole_seconds_ = 1.0;  ///< that the undisturbed run took here
};

void StoppedRunTest::stop_often(const std::string& out, int times, unsigned seed,
                                Ranks ranks) const {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> moment(0.0, 0.7 * whole_seconds_);
  const char* stops[] = {"pkill -TERM -x -P $job lbm", "pkill -KILL -x -P $job lbm",
                         "pkill -TERM -x -P $job lbm", "pkill -KILL -x -P $job liggghts"};
  int stopped = 0;
  bool ended = false;
  for (int trial = 0; trial < times; ++trial) {
    if (ended) {  // the last one was too quick: what it did is right, and it begins once more
      expect_like_whole(out);
      fs::remove_all(path(out));
      ended = false;
    }
    const bool first = !fs::exists(path(out + "/checkpoint.h5"));
    const JobResult cut = test::run(
        "(" + job(out, first ? "" : "--restart", ranks) +
            ") & job=$!; for k in $(seq 200); do pgrep -P $job > /dev/null && break; sleep 0.02; "
            "done; sleep " +
            std::to_string(moment(random)) + "; " + stops[trial % 4] + "; wait $job",
        folder_.path(), 300.0);
    ASSERT_FALSE(cut.timed_out) << cut.output;
    ASSERT_EQ(cut.output.find("damaged"), std::string::npos) << trial << cut.output;
    ASSERT_EQ(cut.output.find("is missing"), std::string::npos) << trial << cut.output;
    ended = cut.exit_code == 0;
    if (!ended) ++stopped;
  }
  EXPECT_GE(stopped, times / 2) << "they ended before they were stopped: make the scene longer";
  if (!ended)
    expect_ok(run(out, fs::exists(path(out + "/checkpoint.h5")) ? "--restart" : "", ranks));
  expect_like_whole(out);
}

TEST_F(StoppedRunTest, EqualsTheOneThatWasNot) {
  for (const Ranks ranks : {Ranks{1, 1}, Ranks{1, 2}, Ranks{2, 2}}) {
    for (const char* out : {"whole", "parts"}) fs::remove_all(path(out));
    expect_ok(run("whole", "", ranks));
    expect_ok(run("parts", "--until 0.0075", ranks));
    const JobResult rest = run("parts", "--restart", ranks);
    expect_ok(rest);
    expect_said(rest, "goes on from parts/checkpoint.h5");
    expect_like_whole("parts");
    EXPECT_GT(file("whole/breaks.csv").size(), 1000U);  // some bonds broke, some before that
  }
}

TEST_F(StoppedRunTest, EqualsTheOneThatWasNotWhenOverlapped) {
  change("[coupling]", "[coupling]\nschedule = \"overlapped\"");
  expect_ok(run("whole"));
  expect_ok(run("parts", "--until 0.0075"));
  expect_ok(run("parts", "--restart"));
  expect_like_whole("parts");
}

// The frames of the run that goes on list what broke before.
TEST_F(StoppedRunTest, RemembersItsBrokenBonds) {
  expect_ok(run("whole"));
  expect_ok(run("parts", "--until 0.0075"));
  const std::string breaks = file("parts/breaks.csv");
  const auto broken_before =
      static_cast<std::size_t>(std::count(breaks.begin(), breaks.end(), '\n'));
  ASSERT_GT(broken_before, 1U);
  expect_ok(run("parts", "--restart"));
  const JobResult bonds = test::run(
      "last=$(h5ls parts/fields.h5 | awk '/frame/ {print $1}' | tail -n 1); h5dump -d "
      "/$last/bond_state -w 1 parts/fields.h5 | grep -c '(.*): [12]'",
      folder_.path(), 50.0);
  EXPECT_GE(std::stol("0" + bonds.output), static_cast<long>(broken_before) - 1) << bonds.output;
}

// A signal ends a run at the next interval at which it may be stopped, at most 100 later.
TEST_F(StoppedRunTest, StoppedByASignalOrKilledAFewTimes) {
  change("end_time = 0.014", "end_time = 0.0235");
  expect_ok(run("whole"));
  stop_often("parts", 6, 1);
}

TEST_F(StoppedRunTest, Slow_StoppedTwentyTimesByEach) {
  change("end_time = 0.014", "end_time = 0.0235");
  change("substeps = 10", "substeps = 100");
  for (const Ranks ranks : {Ranks{1, 1}, Ranks{1, 2}}) {
    for (const char* out : {"whole", "parts"}) fs::remove_all(path(out));
    expect_ok(run("whole", "", ranks));
    stop_often("parts", 20, 2 + static_cast<unsigned>(ranks.solid), ranks);
  }
}

// ---- damaged, or of another scene
// ----------------------------------------------------------------

TEST_F(StoppedRunTest, ADamagedPairIsRefusedAndTheOneBeforeIsUsed) {
  expect_ok(run("whole"));
  expect_ok(run("good", "--until 0.0075"));
  const std::string fluid = "parts/checkpoint.h5";
  for (const bool solid : {false, true}) {
    fs::remove_all(path("parts"));
    fs::copy(path("good"), path("parts"), fs::copy_options::recursive);
    flip(solid ? last_part("parts") : fluid, 12345);
    const JobResult rest = run("parts", "--restart");
    expect_ok(rest);
    expect_said(rest, "the last checkpoint is not used: ");
    expect_said(rest,
                solid ? "is damaged, or another file than the solid wrote" : "is damaged: its");
    expect_said(rest, "goes on from parts/checkpoint.before.h5");
    expect_like_whole("parts");
  }
}

TEST_F(StoppedRunTest, AnOlderPartInPlaceOfTheNewerIsRefused) {
  expect_ok(run("parts", "--until 0.0075"));
  fs::copy_file(path(last_part("parts", 1)), path(last_part("parts")),
                fs::copy_options::overwrite_existing);
  fs::remove(path("parts/checkpoint.before.h5"));
  const JobResult rest = run("parts", "--restart");
  EXPECT_EQ(rest.exit_code, 2) << rest.output;
  expect_said(rest, "is damaged, or another file than the solid wrote at that interval");
}

// One bit anywhere in either part; where there is no pair before, nothing goes on.
TEST_F(StoppedRunTest, Slow_FiftyBitsOfEachPart) {
  expect_ok(run("parts", "--until 0.0075"));
  fs::remove(path("parts/checkpoint.before.h5"));
  std::mt19937_64 random(3);
  for (const std::string& part : {std::string("parts/checkpoint.h5"), last_part("parts")})
    for (int trial = 0; trial < 50; ++trial) {
      const std::uint64_t bit = random() >> 8U;
      flip(part, bit);
      const JobResult rest = run("parts", "--restart");
      EXPECT_EQ(rest.exit_code, 2) << part << " bit " << bit << rest.output;
      flip(part, bit);
    }
  expect_ok(run("parts", "--restart"));
}

TEST_F(StoppedRunTest, AnotherSceneIsRefusedWithAListOfWhatDiffers) {
  expect_ok(run("parts", "--until 0.005"));
  const std::string scene = file("scene.toml");
  change("density = 1000.0", "density = 1100.0");
  change("[numerics]", "[numerics]\ncollision = \"bgk\"");
  change("kinematic_viscosity", "body_force = [0.1, 0.0]\nkinematic_viscosity");
  change("[particles]", "[[obstacle]]\ncentre = [0.02, 0.002]\ndiameter = 0.002\n[particles]");
  JobResult rest = run("parts", "--restart");
  EXPECT_EQ(rest.exit_code, 2) << rest.output;
  for (const char* line :
       {"fluid.density: 1000 then, 1100 now", "numerics.collision: auto then, bgk now",
        "plan.collision: central_moment then, bgk now",
        "fluid.body_force: [0, 0] then, [0.1, 0] now",
        "obstacle.1.diameter: not given then, 0.002 now"})
    expect_said(rest, line);

  folder_.write("scene.toml", scene);  // what may change
  change("end_time = 0.014", "end_time = 0.0075");
  change("probe_every = 1e-4", "probe_every = 2e-4");
  change("timeout = 60.0", "timeout = 50.0");
  expect_ok(run("parts", "--restart"));

  change("end_time = 0.0075", "end_time = 0.0085");  // what may if it is meant
  change("pressure = 4000.0", "pressure = 4400.0");
  rest = run("parts", "--restart");
  EXPECT_EQ(rest.exit_code, 2) << rest.output;
  expect_said(rest, "boundary.1.pressure: 4000 then, 4400 now");
  expect_said(rest, "give --accept KEY");
  rest = run("parts", "--restart --accept fluid.density");
  EXPECT_EQ(rest.exit_code, 2) << rest.output;
  expect_said(rest, "--accept fluid.density: is nothing that a restart may change");
  expect_ok(run("parts", "--restart --accept boundary.1.pressure"));
}

}  // namespace
