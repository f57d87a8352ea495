// SPDX-License-Identifier: GPL-2.0-or-later
/// The coupled job in three dimensions on any number of ranks of either side: the same trajectories
/// to twelve digits, which is what a probe is written with.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/support/coupled_job.h"

namespace {

using test::JobResult;

/// Spheres sink obliquely through a periodic box, across its faces, an edge and a corner; one is
/// wider than a rank's share of a box cut in four; they do not touch, so nothing is chaotic.
constexpr const char* kScene = R"(
[box]
size = [0.012, 0.010, 0.009]
sides_x = "periodic"
sides_y = "periodic"
sides_z = "periodic"
[fluid]
density = 1000.0
kinematic_viscosity = 1e-5
gravity = [1.5, 0.7, -3.0]
velocity_scale = 0.05
[particles]
diameter = 0.003
density = DENSITY
start = [[0.0001, 0.0002, 0.0001], [0.006, 0.0051, 0.0042], [0.0119, 0.0049, 0.0065]]
contact_stiffness = 1000.0
[particles.variables]
damping_ratio = 0.5
[numerics]
cell = 0.0005
[coupling]
lubrication_range = 1.0
[run]
end_time = 0.06
checkpoint_every = 0.03
[output]
probe_every = 0.001
fields_every = 0.02
)";

constexpr double kAlike = 1e-12;

/// One unit in the last of the twelve digits that a probe is written with: by so much rounding
/// parts numbers that are alike. (At full precision these trajectories agree to 1e-13.)
double last_place(double number) {
  return number == 0.0 ? 0.0 : std::pow(10.0, std::floor(std::log10(std::abs(number))) - 11.0);
}

class ManyRanks : public testing::TestWithParam<std::string> {
 protected:
  ManyRanks() {
    const std::string common = BPLBM_SOURCE_DIR "/cases/common/";
    folder_.write("scene.toml", test::replaced(kScene, "DENSITY", GetParam()));
    std::string atoms;
    for (const char* i : {"1", "2", "3"})
      atoms += "if \"${restart} == 0\" then \"create_atoms 1 single ${particle" + std::string(i) +
               "_x} ${particle" + i + "_y} ${particle" + i + "_z} units box\"\n";
    folder_.write("in.liggghts", test::read_file(common + "box.liggghts") + atoms +
                                     test::read_file(common + "spheres.liggghts"));
  }
  void run(const std::string& out, int fluid, int solid, const std::string& options = "") const {
    const JobResult result = test::run(
        test::mpirun({test::kLbm + " --progress none --out " + out + " " + options, fluid},
                     {test::kLiggghts + " -screen none -log none", solid}),
        folder_.path(), 60.0);
    ASSERT_EQ(result.exit_code, 0) << result.output;
  }
  std::string log(const std::string& out) const {
    return test::read_file(folder_.path() + "/" + out + "/lbm.log");
  }
  using Table = std::vector<std::vector<double>>;
  Table probes(const std::string& out) const {
    return test::read_rows(folder_.path() + "/" + out + "/probes.csv");
  }
  /// Alike in relation to the largest number of a column, as far as the digits written can tell.
  static void expect_alike(const Table& a, const Table& b) {
    ASSERT_EQ(a.size(), b.size());
    ASSERT_GT(a.size(), 100U);
    for (std::size_t column = 0; column < a[0].size(); ++column) {
      double largest = 0.0, difference = 0.0;
      for (std::size_t i = 0; i < a.size(); ++i) {
        if (std::isnan(a[i][column])) continue;  // no loads at the last state
        largest = std::max(largest, std::abs(a[i][column]));
        difference = std::max(
            difference, std::abs(a[i][column] - b[i][column]) - 1.01 * last_place(a[i][column]));
      }
      EXPECT_LE(difference, kAlike * largest) << "column " << column;
    }
  }
  test::TemporaryFolder folder_;
};

TEST_P(ManyRanks, GiveTheSameTrajectories) {
  run("one", 1, 1);
  const Table one = probes("one");
  run("many", 2, 1);
  expect_alike(one, probes("many"));
  run("many", 4, 3);
  expect_alike(one, probes("many"));
  run("many", 4, 2, "--grid 2 2 1");  // rows are cut
  expect_alike(one, probes("many"));
}

TEST_P(ManyRanks, GoOnFromACheckpointOfOthers) {
  run("one", 1, 1);
  run("many", 2, 1, "--until 0.05");
  run("many", 3, 1, "--restart --grid 1 3 1");
  expect_alike(probes("one"), probes("many"));
}

// Blocks of equal work: at the start from the places in the scene, and after a restart from the
// checkpoint.
class BlocksOfEqualWork : public ManyRanks {};
TEST_P(BlocksOfEqualWork, GiveTheSameTrajectories) {
  run("one", 1, 1);
  folder_.write("work.toml", "[numerics]\nblocks = \"equal_work\"\n");
  run("many", 3, 2, "scene.toml work.toml --until 0.04");
  EXPECT_NE(log("many").find("of the mean work for the busiest"), std::string::npos);
  run("many", 2, 1, "scene.toml work.toml --restart");
  EXPECT_NE(log("many").find("of the mean work for the busiest"), std::string::npos);
  expect_alike(probes("one"), probes("many"));
}

// Heavier than the fluid, and so light that a virtual mass is at work.
INSTANTIATE_TEST_SUITE_P(Densities, ManyRanks, testing::Values("2500.0", "400.0"),
                         [](const auto& info) {
                           return info.param == "400.0" ? std::string("light") : "heavy";
                         });

INSTANTIATE_TEST_SUITE_P(Heavy, BlocksOfEqualWork, testing::Values("2500.0"));

TEST(ManyFluidRanks, AloneWithFieldsAndPoints) {
  const test::TemporaryFolder folder;
  const std::string scene = BPLBM_SOURCE_DIR "/cases/sphere_array/scene.toml";
  const std::string overlay =
      folder.write("overlay.toml",
                   "[run]\nend_time = 0.1\n[output]\npoints = [[0.0002, 0.0003, 0.0004]]\n"
                   "fields_every = 0.05\n");
  const auto start = [&](const std::string& out, int ranks) {
    const JobResult result = test::run(
        "exec env OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1 "
        "OMPI_MCA_mpi_yield_when_idle=1 mpirun --bind-to none --oversubscribe -np " +
            std::to_string(ranks) + " " + test::kLbm + " " + scene + " " + overlay +
            " --progress none --out " + out,
        folder.path(), 50.0);
    ASSERT_EQ(result.exit_code, 0) << result.output;
  };
  start("one", 1);
  start("three", 3);
  for (const char* name : {"points.csv", "fields.xdmf"})
    EXPECT_EQ(test::read_file(folder.path() + "/one/" + name),
              test::read_file(folder.path() + "/three/" + name))
        << name;
  const JobResult same = test::run("h5diff one/fields.h5 three/fields.h5", folder.path(), 50.0);
  EXPECT_EQ(same.exit_code, 0) << same.output;
}

// Of a field and a checkpoint rank 0 has a piece at a time. All cells of the checkpoint would be
// 319 MB more, those of its own block 80 MB, and its share of the lattice is 40 MB.
TEST(ManyFluidRanks, TheFirstNeedsNoMoreMemoryThanOthers) {
  const test::TemporaryFolder folder;
  folder.write("scene.toml", R"(
[box]
size = [1.28, 1.28, 1.28]
[fluid]
density = 1000.0
kinematic_viscosity = 0.01
velocity_scale = 0.1
[[boundary]]
side = "top"
kind = "moving_wall"
velocity = [0.1, 0.0, 0.0]
[numerics]
cell = 0.01
precision = "single"
[run]
end_time = 0.04
checkpoint_every = 0.02
[output]
fields_every = 0.02
)");
  const auto start = [&](const std::string& options) {
    const JobResult result = test::run(
        "exec env OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1 "
        "OMPI_MCA_mpi_yield_when_idle=1 mpirun --bind-to none --oversubscribe -np 4 " +
            test::kLbm + " scene.toml --progress none --out out " + options,
        folder.path(), 60.0);
    ASSERT_EQ(result.exit_code, 0) << result.output;
    const std::string summary = test::read_file(folder.path() + "/out/summary.json");
    const auto number = [&](const std::string& key) {
      const std::size_t at = summary.find("\"" + key + "\":");
      return at == std::string::npos ? 0.0 : std::strtod(&summary[at + key.size() + 3], nullptr);
    };
    EXPECT_GT(number("first_rank"), 40.0) << summary;
    EXPECT_LT(number("first_rank"), 1.2 * number("all") / 4.0) << summary;
    EXPECT_GT(number("checkpoints"), 0.0) << summary;
    EXPECT_GT(number("fields"), 0.0) << summary;
  };
  start("--until 0.03");
  start("--restart");
}

TEST(ManyFluidRanks, AreRefusedWhereTheyCannotWork) {
  const test::TemporaryFolder folder;
  const std::string cases = BPLBM_SOURCE_DIR "/cases/";
  const auto start = [&](const std::string& arguments) {
    return test::run(
        "exec env OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1 "
        "OMPI_MCA_mpi_yield_when_idle=1 mpirun --bind-to none --oversubscribe -np 2 " +
            test::kLbm + " " + cases + arguments,
        folder.path(), 50.0);
  };
  for (const char* name : {"bounce_back", "interpolated_bounce_back", "implicit_immersed_boundary",
                           "spring_immersed_boundary"}) {
    const std::string overlay =
        folder.write("overlay.toml", "[numerics]\nscheme = \"" + std::string(name) + "\"\n");
    const JobResult scheme = start("cylinder_array/scene.toml " + overlay);
    EXPECT_EQ(scheme.exit_code, 2) << scheme.output;
    EXPECT_NE(scheme.output.find("\"" + std::string(name) + "\" works on one rank only"),
              std::string::npos)
        << scheme.output;
  }
  const JobResult grid = start("sphere_array/scene.toml --grid 3 1 1");
  EXPECT_EQ(grid.exit_code, 2) << grid.output;
  EXPECT_NE(grid.output.find("--grid"), std::string::npos) << grid.output;
}

}  // namespace
