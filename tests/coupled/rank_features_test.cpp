// SPDX-License-Identifier: GPL-2.0-or-later
/// What a fluid alone can have, on one rank and on several: the same tables to 1e-11 of a column's
/// largest number, which are written with twelve digits. The rows of docs/parallel.md.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <map>
#include <sstream>

#include "tests/support/coupled_job.h"

namespace {

using test::JobResult;

/// Of a run of few steps; each scene has as much as fits together.
struct Case {
  const char* name;
  const char* scene;
  std::vector<std::string> grids;  ///< x y z
};

/// Openings, a power law, obstacles at rest, every sensor, averages.
constexpr const char* kSpatial = R"(
[box]
size = [0.024, 0.020, 0.018]
sides_z = "periodic"
[fluid]
density = 1000.0
velocity_scale = 0.02
[fluid.viscosity]
model = "power_law"
consistency = 0.01
index = 0.7
shear_rate = 10.0
[[boundary]]
side = "left"
kind = "velocity"
velocity = [0.01, 0.0, 0.0]
profile = "parabolic"
[[boundary]]
side = "right"
kind = "outflow"
[[boundary]]
side = "top"
kind = "moving_wall"
velocity = [0.01, 0.0, 0.0]
[[obstacle]]
centre = [0.008, 0.009, 0.0085]
diameter = 0.006
[[obstacle]]
from = [0.016, 0.0, 0.004]
to = [0.019, 0.006, 0.012]
[numerics]
cell = 0.001
[run]
end_time = 0.1
[output]
fields_every = 0.1
viscosity = true
points = [[0.0101, 0.0123, 0.0091], [0.0021, 0.0052, 0.0002]]
[average]
from = 0.05
[[sensor]]
name = "plane"
kind = "plane"
axis = "x"
at = 0.012
[[sensor]]
name = "line"
kind = "line"
from = [0.001, 0.002, 0.003]
to = [0.022, 0.018, 0.015]
count = 5
[[sensor]]
name = "side"
kind = "side"
side = "bottom"
)";

/// A mesh that moves, across the cuts.
constexpr const char* kMoving = R"(
[box]
size = [0.024, 0.020, 0.018]
[fluid]
density = 1000.0
kinematic_viscosity = 1e-5
velocity_scale = 0.02
[[obstacle]]
from = [0.0131, 0.0118, 0.0052]
to = [0.0182, 0.0163, 0.0127]
motion = "rotation"
angular_velocity = 2.0
axis = [0, 0, 1]
[numerics]
cell = 0.001
[run]
end_time = 0.1
)";

/// A drum, a disc that oscillates, turbulence, a force that changes.
constexpr const char* kFlat = R"(
[box]
size = [0.06, 0.06]
[fluid]
density = 1000.0
kinematic_viscosity = 1e-5
body_force = [0.5, 0.0]
body_force_ramp = 0.02
body_force_frequency = 5.0
velocity_scale = 0.05
[[obstacle]]
centre = [0.03, 0.03]
diameter = 0.036
hollow = true
motion = "rotation"
angular_velocity = 1.0
[[obstacle]]
centre = [0.028, 0.024]
diameter = 0.006
motion = "oscillation"
amplitude = [0.004, 0.002]
frequency = 2.0
[numerics]
cell = 0.001
smagorinsky = 0.1
solid_term = "layered_noble_torczynski"
collision = "central_moment"
[run]
end_time = 0.1
)";

/// A flow that is held through discs at rest, until it is steady.
constexpr const char* kHeld = R"(
[box]
size = [0.03, 0.02]
sides_x = "periodic"
[fluid]
density = 1000.0
kinematic_viscosity = 1e-5
flow_rate = 1e-4
velocity_scale = 0.02
[[obstacle]]
centre = [0.01, 0.009]
diameter = 0.006
[[obstacle]]
centre = [0.023, 0.012]
diameter = 0.005
[numerics]
cell = 0.001
[run]
end_time = 2.0
steady_below = 1e-3
)";

/// An image with shades of grey, a cylinder, a mesh from a file, a yield stress, an inlet with a
/// profile and a course in time of its own: all from files beside the scene.
constexpr const char* kShapes = R"(
[box]
size = [0.024, 0.020, 0.018]
[fluid]
density = 1000.0
velocity_scale = 0.02
[fluid.viscosity]
model = "herschel_bulkley"
consistency = 0.02
index = 0.8
yield_stress = 0.01
shear_rate = 10.0
[[boundary]]
side = "left"
kind = "velocity"
velocity = [0.01, 0.0, 0.0]
profile_table = "profile.csv"
table = "course.csv"
[[boundary]]
side = "right"
kind = "pressure"
[[obstacle]]
image = "image.raw"
voxel = 0.001
at = [0.006, 0.007, 0.005]
grey_levels = [0, 200]
raw_size = [6, 5, 7]
raw_type = "uint8"
[[obstacle]]
from = [0.016, 0.001, 0.0093]
to = [0.0172, 0.0187, 0.0081]
diameter = 0.0043
[[obstacle]]
mesh = "mesh.stl"
scale = 0.001
move = [0.0195, 0.0122, 0.0031]
[numerics]
cell = 0.001
[run]
end_time = 0.1
[output]
points = [[0.0101, 0.0143, 0.0091], [0.0211, 0.0152, 0.0102]]
[[sensor]]
name = "plane"
kind = "plane"
axis = "x"
at = 0.012
)";

/// The files that kShapes names.
void write_shapes(const test::TemporaryFolder& folder) {
  folder.write("profile.csv", "y,factor\n0.0,0.0\n0.009,1.0\n0.013,0.7\n0.02,0.0\n");
  folder.write("course.csv", "time,factor\n0.0,0.2\n0.04,1.0\n0.1,0.5\n");
  std::string image;
  for (int i = 0; i < 6 * 5 * 7; ++i) image += static_cast<char>(40 * (i * 7 % 11));
  folder.write("image.raw", image);
  const char* corners[] = {"0 0 0", "5 1 0", "1 6 1", "2 2 7"};
  std::string mesh = "solid m\n";
  for (const auto& [a, b, c] : {std::array{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}})
    mesh += std::string("facet normal 0 0 0\nouter loop\nvertex ") + corners[a] + "\nvertex " +
            corners[b] + "\nvertex " + corners[c] + "\nendloop\nendfacet\n";
  folder.write("mesh.stl", mesh + "endsolid m\n");
}

class RankFeatures : public testing::TestWithParam<Case> {
 protected:
  void run(const std::string& out, int ranks, const std::string& options) const {
    const JobResult result = test::run(
        "exec env OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1 "
        "OMPI_MCA_mpi_yield_when_idle=1 mpirun --bind-to none --oversubscribe -np " +
            std::to_string(ranks) + " " + test::kLbm +
            " scene.toml --force --progress none --out " + out + options,
        folder_.path(), 60.0);
    ASSERT_EQ(result.exit_code, 0) << result.output;
  }
  using Table = std::vector<std::vector<double>>;
  std::map<std::string, Table> tables(const std::string& out) const {
    std::map<std::string, Table> all;
    for (const auto& file : std::filesystem::directory_iterator(folder_.path() + "/" + out)) {
      if (file.path().extension() != ".csv") continue;
      all[file.path().filename()] = test::read_rows(file.path());
    }
    return all;
  }
  static void expect_alike(const std::string& name, const Table& a, const Table& b) {
    constexpr double alike = 1e-11;
    ASSERT_EQ(a.size(), b.size()) << name;
    ASSERT_GT(a.size(), 3U) << name;
    for (std::size_t column = 0; column < a[0].size(); ++column) {
      double largest = 0.0, difference = 0.0;
      for (std::size_t i = 0; i < a.size(); ++i) {
        ASSERT_EQ(a[i].size(), b[i].size()) << name;
        largest = std::max(largest, std::abs(a[i][column]));
        difference = std::max(difference, std::abs(a[i][column] - b[i][column]));
      }
      EXPECT_LE(difference, alike * std::max(largest, scale(a, column))) << name << ' ' << column;
    }
  }
  /// Of a vector whose components are columns beside each other: the largest neighbour. A component
  /// that should be nothing is round-off of the others.
  static double scale(const Table& table, std::size_t column) {
    double largest = 0.0;
    const std::size_t first = column < 2 ? 0 : column - 2;
    for (const auto& row : table)
      for (std::size_t c = first; c < std::min(row.size(), column + 3); ++c)
        if (column > 0 && c > 0) largest = std::max(largest, std::abs(row[c]));
    return largest;
  }
  test::TemporaryFolder folder_;
};

TEST_P(RankFeatures, GiveTheSameTables) {
  folder_.write("scene.toml", GetParam().scene);
  write_shapes(folder_);
  run("one", 1, "");
  const auto one = tables("one");
  ASSERT_FALSE(one.empty());
  for (const std::string& grid : GetParam().grids) {
    SCOPED_TRACE(grid);
    int ranks = 1, n = 0;
    for (std::istringstream numbers(grid); numbers >> n;) ranks *= n;
    run("many", ranks, " --grid " + grid);
    const auto many = tables("many");
    ASSERT_EQ(many.size(), one.size());
    for (const auto& [name, table] : one) expect_alike(name, table, many.at(name));
    for (const char* file : {"fields.h5", "averages.h5"}) {
      if (!std::filesystem::exists(folder_.path() + "/one/" + file)) continue;
      // single precision in the file: its last digit, and a pressure that is nothing
      const JobResult same = test::run(std::string("h5diff -d 3e-7 one/") + file + " many/" + file,
                                       folder_.path(), 50.0);
      EXPECT_EQ(same.exit_code, 0) << file << '\n' << same.output;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Scenes, RankFeatures,
                         testing::Values(Case{"spatial", kSpatial, {"1 1 3", "2 2 1"}},
                                         Case{"moving", kMoving, {"1 1 3"}},
                                         Case{"flat", kFlat, {"1 3 1", "2 1 1"}},
                                         Case{"held", kHeld, {"2 1 1"}},
                                         Case{"shapes", kShapes, {"1 1 2", "2 2 1"}}),
                         [](const auto& info) { return std::string(info.param.name); });

}  // namespace
