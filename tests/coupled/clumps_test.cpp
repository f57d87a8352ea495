// SPDX-License-Identifier: GPL-2.0-or-later
/// Clumps of LIGGGHTS in the fluid: those of fix multisphere and of fix rigid.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <sstream>
#include <string>
#include <vector>

#include "tests/support/clump_job.h"

namespace {

using test::Clumps;
using test::heavy;
using test::JobResult;
using test::kLbm;
using test::kRigid;
using test::mpirun;
using test::multisphere;

TEST_F(Clumps, OfMultisphereThatAreNeutralStayWhereTheyAre) {
  // Its density is the fluid's, and its volume that of its template: weight and buoyancy are equal
  // to round-off. Counted once a sphere it rose at 7 cm/s.
  const JobResult job = run(multisphere("1000"));
  test::expect_end(job, 0, {});
  const auto path = rows("out", true);
  ASSERT_GT(path.size(), 5U);
  for (int axis = 2; axis < 5; ++axis)
    EXPECT_NEAR(path.back()[axis], path.front()[axis], 1e-6 * 0.003);
  EXPECT_EQ(rows("out", false).size(), 2 * path.size());
}

TEST_F(Clumps, Slow_OfMultisphereThatAreNeutralStayWhereTheyAreForASecond) {
  const std::string scene = test::replaced(test::kClumpScene, "end_time = 0.05", "end_time = 1.0");
  const std::string script = test::replaced(test::kClumpScript, "BODIES", multisphere("1000"));
  test::expect_end(run_script(script, scene, 1, 1, "--out out", 550.0), 0, {});
  const auto path = rows("out", true);
  ASSERT_GT(path.size(), 100U);
  double off = 0.0;  // m, at any time
  for (const Row& row : path)
    for (int axis = 2; axis < 5; ++axis)
      off = std::max(off, std::abs(row[axis] - path.front()[axis]));
  std::printf("a neutral clump within %.2g of its spheres' diameter\n", off / 0.003);
  EXPECT_LT(off, 1e-6 * 0.003);
}

/// Rows of the clump of two runs are equal to round-off, summed in another order.
void expect_alike(const std::vector<std::array<double, 17>>& one,
                  const std::vector<std::array<double, 17>>& other) {
  ASSERT_EQ(one.size(), other.size());
  ASSERT_GT(one.size(), 5U);
  const double scales[17] = {1, 1, 1e-3, 1e-3, 1e-3, 0.1,  0.1,  0.1, 1,
                             1, 1, 1e-4, 1e-4, 1e-4, 1e-7, 1e-7, 1e-7};
  for (std::size_t k = 0; k < one.size(); ++k)
    for (std::size_t c = 0; c < 17; ++c)
      EXPECT_NEAR(one[k][c], other[k][c], 1e-8 * scales[c]) << "row " << k << ", column " << c;
}

TEST_F(Clumps, Slow_OfMultisphereFallAlikeOnAnyNumberOfRanksOfTheFluid) {
  // across the border of the two ranks of both programs, at 9 mm
  test::expect_end(run(multisphere("2500"), heavy(2500), 1, 2, "--out one"), 0, {});
  test::expect_end(run(multisphere("2500"), heavy(2500), 2, 2, "--out two"), 0, {});
  const auto one = rows("one", true);
  expect_alike(one, rows("two", true));
  EXPECT_GT(one.front()[4], 0.0095);
  EXPECT_LT(one.back()[4], 0.0088);
}

TEST_F(Clumps, Slow_OfRigidFallAlikeOnAnyNumberOfRanks) {
  const std::string scene =
      test::replaced(heavy(2500), "density = 2500.000000", "density = [2490.0, 2510.0]");
  test::expect_end(run(kRigid, scene, 1, 1, "--out one"), 0, {});
  test::expect_end(run(kRigid, scene, 2, 2, "--out two"), 0, {});
  const auto one = rows("one", true);
  expect_alike(one, rows("two", true));
  EXPECT_LT(one.back()[4], 0.0090);
}

TEST_F(Clumps, OfRigidThatLieInSeveralRanksFallAlike) {
  // one that reaches into the cells and the particles of both ranks of both programs, for 10 ms
  std::string scene =
      test::replaced(heavy(2500), "density = 2500.000000", "density = [2490.0, 2510.0]");
  scene = test::replaced(scene, "end_time = 0.05", "end_time = 0.01");
  scene = test::replaced(scene, "probe_every = 0.005", "probe_every = 0.001");
  const std::string bodies = test::replaced(kRigid, "0.006 0.011", "0.006 0.0092");
  test::expect_end(run(bodies, scene, 1, 1, "--out one"), 0, {});
  test::expect_end(run(bodies, scene, 2, 2, "--out two"), 0, {});
  expect_alike(rows("one", true), rows("two", true));
}

/// m ΔU = Σ T F + m g t over any number of intervals, with one mass along all three axes, those of
/// which no force is the load's impulse included: Verlet's half-steps of a load that changes from
/// one interval to the next are made up for (ParticleCoupling), also at the beginning.
/// @param weighed  the first interval that has all of the weight: fix rigid, set up before fix
///                 gravity, lacks a half-step of it in interval 1
void expect_impulse(const std::vector<std::array<double, 17>>& path, double mass, double off,
                    std::size_t weighed = 1) {
  ASSERT_GT(path.size(), 20U);
  const double interval = path[1][0] - path[0][0];
  for (std::size_t k = 1; k < path.size(); ++k)
    for (int a = 0; a < (k < weighed ? 2 : 3); ++a) {
      const double weight = a == 2 ? -9.81 * mass : 0.0;
      // a row has the state at its time and the load of the interval that begins there
      EXPECT_NEAR(mass * (path[k][5 + a] - path[k - 1][5 + a]),
                  interval * (path[k - 1][11 + a] + weight),
                  off * interval * (std::abs(path[k - 1][11 + a]) + 9.81 * mass))
          << "interval " << k << ", axis " << a;
    }
}

TEST_F(Clumps, TakeTheImpulseOfTheirLoads) {
  std::string scene = test::replaced(heavy(1500), "probe_every = 0.005\n", "");
  scene = test::replaced(scene, "end_time = 0.05", "end_time = 0.01");
  test::expect_end(run(multisphere("1500", "0.05 0.03 0.0"), scene, 1, 1, "--out of_multisphere"),
                   0, {});
  // its mass is that of LIGGGHTS' samples: 0.3 % of what two balls less their lens have
  expect_impulse(rows("of_multisphere", true), 1500.0 * 2.0944e-8, 0.003);
  const std::string light = test::replaced(kRigid, "1851.86", "1111.12");
  scene = test::replaced(scene, "density = 1500.000000", "density = [1490.0, 1510.0]");
  test::expect_end(
      run(light + "\nvelocity all set 0.05 0.03 0.0 units box", scene, 1, 1, "--out of_rigid"), 0,
      {});
  expect_impulse(rows("of_rigid", true), 1111.12 * 2.0 * 1.41371669e-8, 1e-6, 2);
}

// Through the open side below: one clump of two spheres, which counts once, side by side and one
// above the other, where the upper one is no grain of its own when the lower one has left.
TEST_F(Clumps, ThatLeaveAnOpenBoxCountOnce) {
  const std::string scene = test::replaced(heavy(2500), "end_time = 0.05", "end_time = 0.04") +
                            "[[boundary]]\nside = \"back\"\nkind = \"pressure\"\n";
  const std::string in_box = test::replaced(
      test::replaced(test::kClumpScript, "BODIES", multisphere("2500", "0. 0. -0.15")),
      "fix z all wall/gran model hertz tangential history primitive type 1 zplane ${z_lo}\n",
      "thermo_modify lost ignore\n");
  const std::string script = test::replaced(in_box, "0.0105 0.0115", "0.0015 0.0025");
  for (const int ranks : {1, 2}) {
    folder_.write("two.txt",
                  ranks == 1 ? "0 0 -0.5 1.5\n0 0 0.5 1.5\n" : "-0.5 0 0 1.5\n0.5 0 0 1.5\n");
    const JobResult job = run_script(script, scene, 1, ranks, "--out " + std::to_string(ranks));
    test::expect_end(job, 0, {"1 grains left"});
    EXPECT_EQ(job.output.find("no fix of the script moves"), std::string::npos);
  }
}

TEST_F(Clumps, OfMultisphereGoOnFromACheckpointAsTheRunThatWasNot) {
  const std::string scene = heavy(2500) + "checkpoint_every = 0.01\n";
  test::expect_end(run(multisphere("2500"), scene, 1, 1, "--out whole"), 0, {});
  test::expect_end(run(multisphere("2500"), scene, 1, 1, "--out cut --until 0.03"), 0, {});
  const JobResult job = run(multisphere("2500"), scene, 1, 1, "--out cut --restart");
  test::expect_end(job, 0, {});
  EXPECT_EQ(test::read_file(folder_.path() + "/cut/probes.csv"),
            test::read_file(folder_.path() + "/whole/probes.csv"));
}

TEST_F(Clumps, OfRigidRefuseCheckpointsWithTheReason) {
  const std::string scene =
      test::replaced(heavy(2500), "density = 2500.000000", "density = [2490.0, 2510.0]");
  test::expect_end(run(kRigid, scene + "checkpoint_every = 0.01\n"), 1,
                   {"a fix rigid keeps nothing of its bodies in restart files"});
}

// ---- an engine without LIGGGHTS -----------------------------------------------------------------

constexpr const char* kFlat = R"(title = "clumps of discs"
[box]
size = [0.02, 0.03]
[fluid]
density = 1000.0
kinematic_viscosity = 1e-5
gravity = [0.0, -9.81]
velocity_scale = 0.1
[particles]
diameter = 0.002
density = 1500.0
start = [[0.0098, 0.0152], [0.0041, 0.0221]]
[particles.variables]
clump = "-0.001,0,0,0.001:0,0.0002,0,0.001:0.001,0,0,0.001"
[numerics]
cell = 0.0002
[coupling]
substeps = 3
timeout = 100.0
[output]
probe_every = 0.005
[run]
end_time = 0.04
)";

class ClumpEngine : public testing::Test {
 protected:
  JobResult run(const std::string& scene, int fluids, const std::string& out) {
    folder_.write("scene.toml", scene);
    const std::string engine =
        "/usr/bin/python3 " BPLBM_SOURCE_DIR "/tools/engines/python/clump_engine.py";
    return test::run(mpirun({kLbm + " --progress none --out " + out, fluids}, {engine}),
                     folder_.path(), 100.0);
  }
  std::string probes(const std::string& out) const {
    return test::read_file(folder_.path() + "/" + out + "/probes.csv");
  }
  test::TemporaryFolder folder_;
};

TEST_F(ClumpEngine, FallsAlikeOnOneAndTwoRanksOfTheFluid) {
  test::expect_end(run(kFlat, 1, "one"), 0, {});
  test::expect_end(run(kFlat, 2, "two"), 0, {});
  std::istringstream one(probes("one")), two(probes("two"));
  std::string a, b;
  int rows = 0;
  for (; std::getline(one, a) && std::getline(two, b); ++rows) {
    std::istringstream left(a), right(b);
    std::string x, y;
    while (rows > 0 && std::getline(left, x, ',') && std::getline(right, y, ','))
      EXPECT_NEAR(std::stod(x), std::stod(y), 1e-8 * std::max(1e-3, std::abs(std::stod(x)))) << a;
  }
  EXPECT_GT(rows, 50);  // of two clumps and their six discs
}

TEST_F(ClumpEngine, OfMarkersIsRefusedWithTheReason) {
  const std::string scene = test::replaced(
      kFlat, "cell = 0.0002", "cell = 0.0002\nscheme = \"implicit_immersed_boundary\"");
  test::expect_end(run(scene, 1, "out"), 2,
                   {"numerics.scheme = implicit_immersed_boundary", "whose spheres overlap"});
}

}  // namespace
