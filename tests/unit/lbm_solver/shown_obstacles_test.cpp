// SPDX-License-Identifier: GPL-2.0-or-later
/// Frames show obstacles where they are: walls that move, round ones, images; and nothing of a
/// scene that has none.
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <omp.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "lbm_solver/coupling/run.h"
#include "lbm_solver/io/log.h"
#include "lbm_solver/io/scene_reader.h"
#include "lbm_solver/io/stl_file.h"
#include "lbm_solver/solver/plan.h"
#include "protocol/transport/hdf5_file.h"
#include "tests/support/job.h"
#include "tests/support/meshes.h"

namespace {

using namespace lbm;
using protocol::hdf5::Handle;

/// A fluid alone of 16 × 16 (× 8) cells of 1 mm, with frames at 0 and 0.02 s.
class ShownObstaclesTest : public testing::Test {
 protected:
  void run(int dimension, const std::string& obstacles, const std::string& sides = "") {
    const std::string scene = folder_.write(
        "scene.toml", "[box]\nsize = " +
                          std::string(dimension == 2 ? "[0.016, 0.016]" : "[0.016, 0.016, 0.008]") +
                          "\n" + sides +
                          "[fluid]\ndensity = 1000.0\nkinematic_viscosity = 1e-4\n"
                          "velocity_scale = 0.5\n[numerics]\ncell = 0.001\n"
                          "[output]\nfields_every = 0.02\n[run]\nend_time = 0.02\n" +
                          obstacles);
    const Scene s = read_scene({scene});
    const Plan plan = make_plan(s);
    RunOptions options;
    options.out = folder_.path();
    Log log;
    const int threads = omp_get_max_threads();
    omp_set_num_threads(1);  // a box so small waits for its threads only
    run_alone(s, plan, Decomposition(plan.domain), options, log);
    omp_set_num_threads(threads);
    end_ = 0.02;
  }
  bool has(int frame, const std::string& name) const {
    const Handle file = open();
    return H5Lexists(file, fmt::format("frame{:06}/{}", frame, name).c_str(), H5P_DEFAULT) > 0;
  }
  std::vector<double> numbers(int frame, const std::string& name) const {
    const Handle file = open();
    const Handle set(H5Dopen2(file, fmt::format("frame{:06}/{}", frame, name).c_str(), H5P_DEFAULT),
                     H5Dclose, "open " + name);
    const Handle space(H5Dget_space(set), H5Sclose, "space");
    std::vector<double> all(H5Sget_simple_extent_npoints(space));
    H5Dread(set, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, all.data());
    return all;
  }
  /// Lowest and highest corner of the walls along an axis.
  std::pair<double, double> reach(int frame, int dimension, int axis) const {
    const auto corners = numbers(frame, "wall_corners");
    double low = 1e9, high = -1e9;
    for (std::size_t k = static_cast<std::size_t>(axis); k < corners.size();
         k += static_cast<std::size_t>(dimension)) {
      low = std::min(low, corners[k]);
      high = std::max(high, corners[k]);
    }
    return {low, high};
  }
  std::string xdmf() const { return test::read_file(folder_.path() + "/fields.xdmf"); }

  test::TemporaryFolder folder_;
  double end_ = 0.0;

 private:
  Handle open() const {
    return protocol::hdf5::open_file(folder_.path() + "/fields.h5", protocol::hdf5::Open::Read);
  }
};

TEST_F(ShownObstaclesTest, AGateIsWhereItIsInEachFrame) {
  run(2,
      "[[obstacle]]\nfrom = [0.002, 0.009]\nto = [0.005, 0.013]\nmotion = \"linear\"\n"
      "velocity = [0.05, -0.1]\n");
  for (const int frame : {0, 1}) {
    const double t = frame * end_;
    const auto [left, right] = reach(frame, 2, 0);
    const auto [low, high] = reach(frame, 2, 1);
    EXPECT_NEAR(left, 0.002 + 0.05 * t, 1e-12) << frame;
    EXPECT_NEAR(right, 0.005 + 0.05 * t, 1e-12) << frame;
    EXPECT_NEAR(low, 0.009 - 0.1 * t, 1e-12) << frame;
    EXPECT_NEAR(high, 0.013 - 0.1 * t, 1e-12) << frame;
  }
  EXPECT_EQ(numbers(0, "wall_cells").size(), 8U);  // four lines
  EXPECT_EQ(numbers(0, "wall_obstacle"), std::vector<double>(4, 1.0));
  EXPECT_NE(xdmf().find("fields.h5:/frame000001/wall_corners"), std::string::npos);
}

TEST_F(ShownObstaclesTest, AMeshThatTurnsIsTurnedInEachFrame) {
  write_stl(folder_.path() + "/blade.stl",
            test::box_mesh({0.004, 0.006, 0.002}, {0.012, 0.010, 0.006}));
  run(3,
      "[[obstacle]]\nmesh = \"blade.stl\"\nmotion = \"rotation\"\naxis = [0, 0, 1]\n"
      "angular_velocity = 20.0\n");
  const auto before = numbers(0, "wall_corners"), after = numbers(1, "wall_corners");
  ASSERT_EQ(before.size(), 24U);
  ASSERT_EQ(after.size(), 24U);
  EXPECT_EQ(numbers(0, "wall_cells").size(), 36U);  // twelve triangles
  const double c = std::cos(20.0 * end_), s = std::sin(20.0 * end_);
  for (std::size_t k = 0; k < 24; k += 3) {
    const double x = before[k] - 0.008, y = before[k + 1] - 0.008;
    EXPECT_NEAR(after[k], 0.008 + c * x - s * y, 1e-9);
    EXPECT_NEAR(after[k + 1], 0.008 + s * x + c * y, 1e-9);
    EXPECT_NEAR(after[k + 2], before[k + 2], 1e-9);
  }
}

// The wall of a drum stays in its cells; a line in it turns as the wall does.
TEST_F(ShownObstaclesTest, ADrumHasALineThatTurns) {
  run(2,
      "[[obstacle]]\ncentre = [0.008, 0.008]\ndiameter = 0.010\nhollow = true\n"
      "motion = \"rotation\"\nangular_velocity = 10.0\nsurface_only = true\n");
  const auto before = numbers(0, "wall_corners"), after = numbers(1, "wall_corners");
  ASSERT_EQ(before.size(), after.size());
  const std::size_t mark = before.size() - 4;
  for (std::size_t k = 0; k < mark; ++k) EXPECT_EQ(before[k], after[k]);
  for (std::size_t k = 0; k < mark; k += 2)
    EXPECT_NEAR(std::hypot(before[k] - 0.008, before[k + 1] - 0.008), 0.005, 1e-6);
  EXPECT_NEAR(after[mark], 0.008 + 0.005 * std::cos(10.0 * end_), 1e-12);
  EXPECT_NEAR(after[mark + 1], 0.008 + 0.005 * std::sin(10.0 * end_), 1e-12);
}

TEST_F(ShownObstaclesTest, RoundOnesHaveCentreAndRadiusAndComeBackThroughPeriodicSides) {
  run(2,
      "[[obstacle]]\ncentre = [0.004, 0.004]\ndiameter = 0.004\n[[obstacle]]\n"
      "centre = [0.015, 0.011]\ndiameter = 0.003\nmotion = \"linear\"\nvelocity = [0.15, 0.0]\n",
      "sides_x = \"periodic\"\n");
  EXPECT_EQ(numbers(0, "round_radius"), (std::vector{0.002, 0.0015}));
  EXPECT_EQ(numbers(0, "round_obstacle"), (std::vector{1.0, 2.0}));
  const auto after = numbers(1, "round_places");
  EXPECT_EQ(after[0], 0.004);
  EXPECT_NEAR(after[2], 0.015 + 0.15 * end_ - 0.016, 1e-12);
  EXPECT_NEAR(after[3], 0.011, 1e-12);
  EXPECT_FALSE(has(1, "round_radius"));
  EXPECT_FALSE(has(0, "wall_cells"));
}

TEST_F(ShownObstaclesTest, WhatStandsIsInTheFirstFrameAlone) {
  run(3, "[[obstacle]]\nfrom = [0.004, 0.004, 0.002]\nto = [0.012, 0.008, 0.005]\n");
  EXPECT_TRUE(has(0, "wall_corners"));
  EXPECT_FALSE(has(1, "wall_corners"));
  const auto [low, high] = reach(0, 3, 2);
  EXPECT_EQ(low, 0.002);
  EXPECT_EQ(high, 0.005);
  // both frames of the block `walls` show those corners
  const std::string text = xdmf(), corners = "fields.h5:/frame000000/wall_corners";
  const std::size_t first = text.find(corners);
  EXPECT_NE(first, std::string::npos);
  EXPECT_NE(text.find(corners, first + 1), std::string::npos);
  EXPECT_EQ(text.find("image_fraction"), std::string::npos);
}

// A cell of two by two voxels has their mean, and a block beside the image is none of it.
TEST_F(ShownObstaclesTest, AnImageIsItsCells) {
  std::string bytes(64, '\0');
  for (const int solid : {0, 1, 8, 9, 10}) bytes[static_cast<std::size_t>(solid)] = '\xff';
  folder_.write("rock.raw", bytes);
  run(2,
      "[[obstacle]]\nimage = \"rock.raw\"\nraw_size = [8, 8]\nraw_type = \"uint8\"\n"
      "voxel = 0.0005\nthreshold = 128\nat = [0.003, 0.005]\n"
      "[[obstacle]]\nfrom = [0.010, 0.010]\nto = [0.012, 0.012]\n");
  const auto image = numbers(0, "image_fraction"), solid = numbers(0, "solid_fraction");
  ASSERT_EQ(image.size(), 256U);
  for (std::size_t k = 0; k < 256; ++k) {
    const std::size_t x = k % 16, y = k / 16;
    const double expected = y != 5 ? 0.0 : x == 3 ? 1.0 : x == 4 ? 0.25 : 0.0;
    EXPECT_EQ(image[k], expected) << x << ", " << y;
    if (x >= 10 && x < 12 && y >= 10 && y < 12) {
      EXPECT_EQ(solid[k], 1.0);
    }
  }
  EXPECT_FALSE(has(1, "image_fraction"));
  EXPECT_NE(xdmf().find("fields.h5:/frame000000/image_fraction"), std::string::npos);
}

TEST_F(ShownObstaclesTest, AFluidAloneHasNothingOfIt) {
  run(2, "");
  for (const char* name : {"wall_cells", "wall_corners", "round_places", "image_fraction"})
    EXPECT_FALSE(has(0, name)) << name;
  for (const char* name : {"walls", "round_obstacles", "image_fraction"})
    EXPECT_EQ(xdmf().find(name), std::string::npos) << name;
}

}  // namespace
