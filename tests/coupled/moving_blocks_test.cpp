// SPDX-License-Identifier: GPL-2.0-or-later
/// Blocks of equal work that are cut anew while a packing sinks through the box.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <sstream>

#include "tests/support/coupled_job.h"

namespace {

using test::JobResult;

/// Four spheres sink from the upper third of a tall box past a block and past each other, and do
/// not touch, so nothing is chaotic. waiting_bound = 0: no clock is asked. Everything that keeps
/// something of cells or of a rank watches.
constexpr const char* kScene = R"(
[box]
size = [0.02, 0.02, 0.048]
[fluid]
density = 1000.0
kinematic_viscosity = 1e-5
gravity = [0.0, 0.0, GRAVITY]
velocity_scale = 0.12
[[obstacle]]
from = [0.0, 0.008, 0.02]
to = [0.002, 0.013, 0.026]
[[obstacle]]
centre = [0.018, 0.01, 0.012]
diameter = 0.005
[particles]
diameter = 0.005
density = DENSITY
start = [[0.005, 0.005, 0.042], [0.015, 0.0052, 0.04], [0.0051, 0.015, 0.036], [0.0148, 0.0149, 0.038]]
contact_stiffness = 40.0
[particles.variables]
damping_ratio = 0.5
[numerics]
cell = 0.001
[coupling]
lubrication_range = 1.0
[run]
end_time = 0.3
checkpoint_every = 0.1
[output]
probe_every = 0.005
fields_every = 0.1
points = [[0.0101, 0.0123, 0.0091], [0.0021, 0.0052, 0.03]]
[average]
from = 0.05
every = 0.01
[[sensor]]
name = "plane"
kind = "plane"
axis = "z"
at = 0.024
every = 0.01
[[sensor]]
name = "side"
kind = "side"
side = "bottom"
every = 0.01
)";

struct Sinking {
  const char *density, *gravity;
};

class MovingBlocks : public testing::TestWithParam<Sinking> {
 protected:
  MovingBlocks() {
    const std::string common = BPLBM_SOURCE_DIR "/cases/common/";
    folder_.write("scene.toml",
                  test::replaced(test::replaced(kScene, "DENSITY", GetParam().density), "GRAVITY",
                                 GetParam().gravity));
    folder_.write("move.toml", "[numerics]\nblocks = \"equal_work\"\nwaiting_bound = 0\n");
    std::string atoms;
    for (const char* i : {"1", "2", "3", "4"})
      atoms += "if \"${restart} == 0\" then \"create_atoms 1 single ${particle" + std::string(i) +
               "_x} ${particle" + i + "_y} ${particle" + i + "_z} units box\"\n";
    folder_.write("in.liggghts", test::read_file(common + "box.liggghts") + atoms +
                                     test::read_file(common + "spheres.liggghts"));
  }
  void run(const std::string& out, int fluid, int solid, const std::string& options) const {
    const JobResult result = test::run(
        test::mpirun({test::kLbm + " --progress none --out " + out + " " + options, fluid},
                     {test::kLiggghts + " -screen none -log none", solid}),
        folder_.path(), 60.0);
    ASSERT_EQ(result.exit_code, 0) << result.output;
  }
  std::string file(const std::string& name) const { return folder_.path() + "/" + name; }
  using Table = std::vector<std::vector<double>>;
  /// Alike in relation to the largest number of a table, which is written with twelve digits.
  static void expect_alike(const Table& a, const Table& b, double alike) {
    ASSERT_EQ(a.size(), b.size());
    ASSERT_GT(a.size(), 10U);
    for (std::size_t column = 0; column < a[0].size(); ++column) {
      double largest = 0.0, difference = 0.0;
      for (std::size_t i = 0; i < a.size(); ++i) {
        for (std::size_t c = std::max<std::size_t>(column, 2) - 2;
             c < std::min(column + 3, a[i].size()); ++c)  // of a vector its largest component
          if (std::isfinite(a[i][c])) largest = std::max(largest, std::abs(a[i][c]));
        if (std::isfinite(a[i][column]))
          difference = std::max(difference, std::abs(a[i][column] - b[i][column]));
      }
      EXPECT_LE(difference, alike * largest) << "column " << column;
    }
  }
  void expect_same_tables(const std::string& one, const std::string& many) const {
    for (const char* name :
         {"probes.csv", "points.csv", "obstacles.csv", "sensor-plane.csv", "sensor-side.csv"}) {
      SCOPED_TRACE(name);
      expect_alike(test::read_rows(file(one + "/" + name)),
                   test::read_rows(file(many + "/" + name)), 1e-11);
    }
  }
  test::TemporaryFolder folder_;
};

/// What the log says of a move: the busiest block's work over the mean, after and before.
std::vector<std::array<double, 2>> moves_in(const std::string& log) {
  std::vector<std::array<double, 2>> moves;
  std::istringstream lines(log);
  for (std::string line; std::getline(lines, line);) {
    const std::size_t at = line.find("cut anew");
    if (at == std::string::npos) continue;
    const std::size_t about = line.find("about ", at), then = line.find("busiest, ", at);
    moves.push_back({std::stod(line.substr(about + 6)), std::stod(line.substr(then + 9))});
  }
  return moves;
}

TEST_P(MovingBlocks, ChangeNothingButTheWaiting) {
  run("one", 1, 1, "scene.toml");
  run("many", 3, 1, "scene.toml move.toml");
  expect_same_tables("one", "many");
  const auto moves = moves_in(test::read_file(file("many/lbm.log")));
  ASSERT_GE(moves.size(), 3U);
  double sums[2] = {0.0, 0.0};
  for (const auto& [after, before] : moves) {
    EXPECT_LE(after, before);
    sums[0] += after;
    sums[1] += before;
  }
  EXPECT_LT(sums[0], sums[1]);
  const JobResult same = test::run("h5diff -p 1e-5 one/averages.h5 many/averages.h5",
                                   folder_.path(), 50.0);  // of single precision
  EXPECT_EQ(same.exit_code, 0) << same.output;
}

// A checkpoint does not know of it: another number of ranks goes on, and moves its own.
TEST_P(MovingBlocks, GoOnFromTheirCheckpoint) {
  run("one", 1, 1, "scene.toml");
  run("many", 2, 2, "scene.toml move.toml --until 0.2");
  run("many", 3, 1, "scene.toml move.toml --restart --grid 1 1 3");
  expect_same_tables("one", "many");
}

// Heavier than the fluid, and so light that a virtual mass is at work: these sink upwards.
INSTANTIATE_TEST_SUITE_P(Densities, MovingBlocks,
                         testing::Values(Sinking{"1800.0", "-4.0"}, Sinking{"400.0", "4.0"}),
                         [](const auto& info) {
                           return info.param.gravity[0] == '4' ? std::string("light") : "heavy";
                         });

}  // namespace
