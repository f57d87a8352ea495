// SPDX-License-Identifier: GPL-2.0-or-later
/// Clumps of the engines that take them from the scene's variable `clump`: the same scene with each
/// of them, contacts, checkpoints.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <sstream>
#include <string>
#include <vector>

#include "tests/support/coupled_job.h"

namespace {

const std::string kEngines = BPLBM_SOURCE_DIR "/tools/engines/";

std::string command(const std::string& engine) {
  if (engine == "reference") return test::kBin + "/reference_engine";
  return "/usr/bin/python3 " + kEngines +
         (engine == "python" ? "python/clump_engine.py" : "yade/engine.py");
}

bool installed(const std::string& engine) {
  return engine != "yade" || std::filesystem::exists("/usr/bin/yade");
}

/// Of each particle places and velocities, an interval of the output after another.
using Row = std::vector<double>;
using Paths = std::map<std::int64_t, std::vector<Row>>;

class ClumpsOfEngines : public testing::Test {
 protected:
  test::JobResult run(const std::string& engine, const std::string& options) const {
    return test::run(test::mpirun({test::kLbm + " --progress none " + options}, {command(engine)}),
                     folder_.path(), 100.0);
  }
  void expect_ok(const std::string& engine, const std::string& options) const {
    const test::JobResult job = run(engine, options);
    ASSERT_EQ(job.exit_code, 0) << engine << job.output;
  }
  std::string probes(const std::string& out) const {
    return test::read_file(folder_.path() + "/" + out + "/probes.csv");
  }
  /// Of a run with an engine, whose output has its name.
  Paths paths(const std::string& engine, int dimension, const std::string& options = "") const {
    expect_ok(engine, "--out " + engine + options);
    Paths all;
    std::istringstream lines(probes(engine));
    std::string line;
    std::getline(lines, line);
    while (std::getline(lines, line)) {
      std::ranges::replace(line, ',', ' ');
      std::istringstream numbers(line);
      double time = 0.0, id = 0.0;
      Row row(2 * static_cast<std::size_t>(dimension));
      numbers >> time >> id;
      for (double& number : row) numbers >> number;
      all[static_cast<std::int64_t>(id)].push_back(row);
    }
    return all;
  }
  test::TemporaryFolder folder_;
};

/// Over the time that both have, of the clumps alone: each engine numbers their spheres its own
/// way.
/// @param place, speed  how far paths may lie apart [m], [m/s]
void expect_same(const Paths& a, const Paths& b, int clumps, double place, double speed) {
  for (int id = 1; id <= clumps; ++id) {
    ASSERT_TRUE(a.contains(id) && b.contains(id)) << id;
    const std::vector<Row>&one = a.at(id), &other = b.at(id);
    const std::size_t rows = std::min(one.size(), other.size());
    ASSERT_GT(rows, 25U);
    double far = 0.0, fast = 0.0;
    for (std::size_t k = 0; k < rows; ++k)
      for (std::size_t c = 0; c < one[k].size(); ++c) {
        double& worst = c < one[k].size() / 2 ? far : fast;
        worst = std::max(worst, std::abs(one[k][c] - other[k][c]));
      }
    EXPECT_LT(far, place) << id;
    EXPECT_LT(fast, speed) << id;
  }
}

const std::string kThree = "-0.001,0,0,0.001:0,0.0004,0,0.001:0.001,0,0,0.0008";
constexpr const char* kFlat = R"(title = "clumps of discs"
[box]
size = [0.02, 0.02]
sides_x = "wall"
sides_y = "wall"
[fluid]
density = 1000.0
kinematic_viscosity = 1e-5
gravity = [0.0, -9.81]
velocity_scale = 0.2
[particles]
diameter = [0.0016, 0.002]
density = 2500.0
start = [[0.0098, 0.0056], [0.0041, 0.0101], [0.0118, 0.0036]]
contact_stiffness = 1.0e4
[particles.variables]
clump = "-0.001,0,0,0.001:0,0.0004,0,0.001:0.001,0,0,0.0008"
[numerics]
cell = 0.00025
[coupling]
timeout = 100.0
[output]
probe_every = 0.001
[run]
end_time = 0.08
)";

// Weight, loads, torques, and springs between clumps and with the ground: one scheme and one
// quadrature of the union, so that round-off is all that differs, and grows with each contact.
// (Dashpots would part them: at the first step of an interval the reference engine takes the
// velocities of now, YADE those of half a step before.) The engine in Python, which has no
// contacts, moves a place with the velocity of a step's end: half a step of 62 µs at 0.1 m/s is
// 3e-6 m.
TEST_F(ClumpsOfEngines, FallAndMeetAlike) {
  std::string scene = test::replaced(kFlat, "[numerics]", "damping_ratio = 0.0\n[numerics]");
  folder_.write("scene.toml", scene);
  const Paths reference = paths("reference", 2), python = paths("python", 2, " --until 0.03");
  expect_same(reference, python, 3, 4e-6, 1e-4);
  const auto on_the_ground = [](const Row& disc) { return disc[1] < 0.001; };
  EXPECT_TRUE(std::ranges::any_of(reference.at(1'000'003), on_the_ground));
  if (!installed("yade")) GTEST_SKIP() << "yade is not installed";
  expect_same(reference, paths("yade", 2), 3, 1e-9, 1e-7);
}

constexpr const char* kSpace = R"(title = "clumps of spheres"
[box]
size = [0.012, 0.012, 0.02]
[fluid]
density = 1000.0
kinematic_viscosity = 1e-5
gravity = [0.0, 0.0, -9.81]
velocity_scale = 0.1
[particles]
diameter = [0.002, 0.003]
density = 2000.0
start = [[0.006, 0.006, 0.014]]
contact_stiffness = 1.0e3
[particles.variables]
clump = "-0.0012,0,0,0.0015:0.0008,0.0006,0,0.001:0.0004,-0.0008,0.0011,0.001"
[numerics]
cell = 0.0005
[coupling]
timeout = 100.0
substeps = 220
[output]
probe_every = 0.001
[run]
end_time = 0.04
)";

// One of three unequal spheres, which tumbles: YADE's integrator of the angular momentum against
// the Python package's, which moves a place with the velocity of a step's end: half a step of 2.3
// µs at 0.1 m/s is 1e-7 m.
TEST_F(ClumpsOfEngines, TumbleAlikeInSpace) {
  if (!installed("yade")) GTEST_SKIP() << "yade is not installed";
  folder_.write("scene.toml", kSpace);
  expect_same(paths("python", 3), paths("yade", 3), 1, 3e-7, 1e-4);
}

TEST_F(ClumpsOfEngines, WhatIsNoneIsNamed) {
  const std::pair<std::string, std::string> wrong[] = {{"reference", "0,0,0"},
                                                       {"reference", "0,0,0,0.001:0,0,0"},
                                                       {"reference", "0,0,0,-1"},
                                                       {"python", "0,0,0,one"},
                                                       {"yade", "0,0,0"}};
  for (const auto& [engine, clump] : wrong) {
    if (!installed(engine)) continue;
    SCOPED_TRACE(engine);
    folder_.write("scene.toml", test::replaced(kFlat, kThree, clump));
    test::expect_end(run(engine, "--out out --force"), 2,
                     {"lbm | error | the solid program stopped: ",
                      "= '" + clump + "' is no list of x,y,z,r:x,y,z,r…"});
  }
}

class ClumpEngineRestart : public ClumpsOfEngines,
                           public testing::WithParamInterface<std::string> {};

// One clump comes at the very interval of the checkpoint, another one has been taken out, and the
// third one lies on the ground.
TEST_P(ClumpEngineRestart, GoesOnToTheBit) {
  if (!installed(GetParam())) GTEST_SKIP() << GetParam() << " is not installed";
  std::string scene = test::replaced(kFlat, "[numerics]",
                                     "particle1_interval = 320\nparticle3_until = 300\n[numerics]");
  scene = test::replaced(scene, "0.0101], [0.0118, 0.0036]", "0.0018], [0.0118, 0.0018]");
  scene = test::replaced(scene, "contact_stiffness = 1.0e4", "contact_stiffness = 1.0e3");
  scene = test::replaced(scene, "end_time = 0.08", "end_time = 0.06\ncheckpoint_every = 0.02");
  folder_.write("scene.toml", scene);
  expect_ok(GetParam(), "--out whole");
  expect_ok(GetParam(), "--out parts --until 0.05");
  expect_ok(GetParam(), "--out parts --restart");
  EXPECT_EQ(probes("parts"), probes("whole"));
}
INSTANTIATE_TEST_SUITE_P(All, ClumpEngineRestart, testing::Values("reference", "yade"),
                         [](const auto& info) { return info.param; });

}  // namespace
