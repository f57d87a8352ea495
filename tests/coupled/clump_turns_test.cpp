// SPDX-License-Identifier: GPL-2.0-or-later
/// How clumps of LIGGGHTS turn by the torque of their loads: the same clump by fix multisphere, by
/// fix rigid and, in two dimensions, which fix multisphere lacks, by an engine without LIGGGHTS.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <string>
#include <vector>

#include "protocol/wire/ball_union.h"
#include "tests/support/clump_job.h"
#include "tests/support/script_parts.h"

namespace {

using test::Clumps;
using test::heavy;
using test::JobResult;
using test::kLbm;
using test::kLiggghts;
using test::mpirun;
using test::multisphere;

/// Columns of a velocity, an angular velocity, a force and a torque in probes.csv.
struct Columns {
  std::size_t velocity, spin, force, torque;
};
constexpr Columns kSpace{7, 9, 13, 15};  // vz, ωy, Fz, My
constexpr Columns kPlane{5, 6, 8, 9};    // vy, ω, Fy, M

using Path = std::vector<std::array<double, 17>>;

double largest(const Path& path, std::size_t column) {
  double most = 0.0;
  for (const auto& row : path) most = std::max(most, std::abs(row[column]));
  return most;
}

/// I ΔΩ = Σ T M about the axis normal to the plane in which a body of revolution, or a disc, falls:
/// on any number of intervals, as with the impulse. @return the largest error over the largest M T
double error_of_turn(const Path& path, double inertia, const Columns& column) {
  EXPECT_GT(path.size(), 20U);
  EXPECT_GT(largest(path, column.spin), 0.1);  // rad/s: there is a turn to speak of
  if (path.size() < 4) return 1.0;
  const double interval = path[1][0] - path[0][0], most = largest(path, column.torque);
  double worst = 0.0;
  for (std::size_t k = 3; k < path.size(); ++k)
    worst = std::max(
        worst, std::abs(inertia * (path[k][column.spin] - path[k - 1][column.spin]) / interval -
                        path[k - 1][column.torque]));
  return worst / most;
}

/// Largest differences of two paths over the largest value of each column; of torques means over
/// ten intervals, since the cells of a body change at other moments where its place differs.
struct Difference {
  double velocity = 0.0, spin = 0.0, force = 0.0, torque = 0.0;
};
Difference difference(const Path& one, const Path& other, const Columns& column) {
  EXPECT_EQ(one.size(), other.size());
  const auto of = [&](std::size_t c, std::size_t window) {
    double most = 0.0;
    for (std::size_t k = 0; k + window <= std::min(one.size(), other.size()); ++k) {
      double sum = 0.0;
      for (std::size_t i = k; i < k + window; ++i) sum += one[i][c] - other[i][c];
      most = std::max(most, std::abs(sum) / static_cast<double>(window));
    }
    return most / largest(other, c);
  };
  return {of(column.velocity, 1), of(column.spin, 1), of(column.force, 1), of(column.torque, 10)};
}

/// @param off_torque  of means of a torque that jumps by a tenth as cells change
void expect_alike(const char* what, const Difference& d, double off, double off_torque) {
  std::printf("%s: velocity %.2g, angular velocity %.2g, force %.2g, torque %.2g of the largest\n",
              what, d.velocity, d.spin, d.force, d.torque);
  EXPECT_LT(d.velocity, off);
  EXPECT_LT(d.spin, off);
  EXPECT_LT(d.force, off);
  EXPECT_LT(d.torque, off_torque);
}

TEST_F(Clumps, TurnByTheTorqueOfTheirLoadsByMultisphereAndByRigidAlike) {
  // A larger and a smaller sphere, side by side: the fluid holds the smaller one back. They overlap
  // by little more than a hundredth, from which on they are one clump for fix rigid; the lens that
  // counts twice is 1e-4 of the volume.
  std::string scene = test::replaced(heavy(2000), "probe_every = 0.005\n", "");
  scene = test::replaced(scene, "end_time = 0.05", "end_time = 0.02");
  scene = test::replaced(scene, "diameter = 0.003", "diameter = [0.0018, 0.003]");
  scene = test::replaced(scene, "density = 2000.000000", "density = [1990.0, 2010.0]");
  const double m = 4.0 / 3.0 * std::numbers::pi * 2000.0, a = 1.5e-3, b = 0.9e-3, apart = 2.37e-3;
  const double ma = m * a * a * a, mb = m * b * b * b;
  const double inertia = 0.4 * (ma * a * a + mb * b * b) + ma * mb / (ma + mb) * apart * apart;
  folder_.write("two.txt", "-0.75 0 0 1.5\n1.62 0 0 0.9\n");
  test::expect_end(run(multisphere("2000"), scene, 1, 1, "--out of_multisphere"), 0, {});
  const auto spheres = rows("of_multisphere", false);
  ASSERT_GT(spheres.size(), 2U);
  std::string made;
  for (int k = 0; k < 2; ++k)
    made += fmt::format(
        "create_atoms 1 single {:.12g} {:.12g} {:.12g} units box\n"
        "set atom {} diameter {} density 2000\n",
        spheres[k][2], spheres[k][3], spheres[k][4], k + 1, k == 0 ? 0.003 : 0.0018);
  const std::string weight = "fix weight all gravity ${gravity} vector 0.0 0.0 -1.0\n";
  const std::string script =
      test::replaced(test::replaced(test::kClumpScript, "BODIES", made), weight,
                     weight + "neigh_modify exclude group all all\nfix move all rigid single\n");
  test::expect_end(run_script(script, scene, 1, 1, "--out of_rigid"), 0, {});
  // LIGGGHTS samples what fix multisphere has: volume to 0.3 %, inertia to 1 %.
  const auto sampled = rows("of_multisphere", true), exact = rows("of_rigid", true);
  const double by_samples = error_of_turn(sampled, inertia, kSpace);
  const double by_spheres = error_of_turn(exact, inertia, kSpace);
  std::printf("change of I Ω against M T: %.2g (fix multisphere), %.2g (fix rigid)\n", by_samples,
              by_spheres);
  EXPECT_LT(by_samples, 0.01);
  EXPECT_LT(by_spheres, 1e-4);  // about y; the walls, nearer on one side, turn it a little about x
  expect_alike("fix rigid against fix multisphere", difference(exact, sampled, kSpace), 0.01, 0.01);
}

constexpr const char* kFlatScene = R"(title = "a clump of two discs"
[box]
size = [0.02, 0.03]
[fluid]
density = 1000.0
kinematic_viscosity = 1e-5
gravity = [0.0, -9.81]
velocity_scale = 0.1
[particles]
diameter = [0.0012, 0.002]
density = 1500.0
start = [[0.0098, 0.0202]]
[particles.variables]
clump = "0,0,0,0.001:0.00158,0,0,0.0006"
[numerics]
cell = 0.0002
[coupling]
substeps = 3
timeout = 100.0
[run]
end_time = 0.03
)";

/// DISCS are made by disc_lines; fix rigid, which takes discs for spheres and counts what two share
/// twice, has mass, centre and inertia from a file.
const std::string kFlatScript = R"(dimension 2
units si
atom_style granular
atom_modify map array sort 0 0
boundary f f p
newton off
communicate single vel yes
region box block ${x_lo} ${x_hi} ${y_lo} ${y_hi} ${z_lo} ${z_hi} units box
create_box 1 box
neighbor 0.0005 bin
neigh_modify delay 0
)" + test::linear_contacts("1e3", "1", "0.3") +
                                test::box_walls(test::kLinear, "xy") + R"(timestep ${solid_step}
DISCS
neigh_modify exclude group all all
fix weight all gravity ${gravity} vector 0.0 -1.0 0.0
fix move all rigid single infile body.txt
fix fluid all lbm/couple every ${substeps}
fix flat all enforce2d
run ${solid_steps_total}
)";

/// The clump of that scene: a larger and a smaller disc that overlap by little more than a
/// hundredth, at the start of the scene.
class FlatClump : public Clumps {
 protected:
  FlatClump() {
    const std::vector<protocol::Ball> balls{{0, {0.0, 0.0, 0.0}, kRadii[0]},
                                            {1, {kApart, 0.0, 0.0}, kRadii[1]}};
    const auto whole = protocol::moments_of_union(balls, 2);
    const double centre = whole.centroid[0];
    mass_ = 1500.0 * whole.volume;
    inertia_ = mass_ * (whole.second[0] + whole.second[1] - centre * centre);
    left_ = 0.0098 - centre;
    of_discs_ = {mass_ * (1.0 - centre / kApart), mass_ * centre / kApart};
    folder_.write("body.txt",
                  fmt::format("1\n1 {0:.12g} 0.0098 0.0202 0 {1:.12g} {1:.12g} {1:.12g} "
                              "0 0 0\n",
                              mass_, inertia_));
    folder_.write("scene.toml", kFlatScene);
  }
  /// @param heavier  factor of the masses of the discs
  JobResult couple(const std::string& solid, const std::string& out, double heavier = 1.0) {
    std::string discs;
    for (int k = 0; k < 2; ++k)
      discs += fmt::format(
          "create_atoms 1 single {:.12g} 0.0202 0.0 units box\n"
          "set atom {} diameter {} density {:.12g}\n",
          left_ + k * kApart, k + 1, 2.0 * kRadii[k],
          heavier * of_discs_[k] / (std::numbers::pi * kRadii[k] * kRadii[k]));
    folder_.write("in.liggghts", test::replaced(kFlatScript, "DISCS\n", discs));
    return test::run(mpirun({kLbm + " --progress none --out " + out}, {solid}), folder_.path(),
                     100.0);
  }
  static constexpr double kRadii[] = {1e-3, 0.6e-3}, kApart = 1.58e-3;
  double mass_, inertia_, left_;
  std::array<double, 2> of_discs_;  // masses with the sum and the centre of the body
};

TEST_F(FlatClump, TurnsByRigidAsByAnEngine) {
  test::expect_end(couple(kLiggghts + " -in in.liggghts", "of_rigid"), 0, {});
  const std::string engine =
      "/usr/bin/python3 " BPLBM_SOURCE_DIR "/tools/engines/python/clump_engine.py";
  test::expect_end(couple(engine, "of_engine"), 0, {});
  const Path rigid = rows("of_rigid", true);
  const Path other = rows_where("of_engine", [](double id) { return id == 1.0; });
  const double error = error_of_turn(rigid, inertia_, kPlane);
  std::printf("change of I Ω against M T: %.2g (fix rigid, discs)\n", error);
  EXPECT_LT(error, 1e-5);
  // The engine steps velocity first, LIGGGHTS in half-steps: a step apart.
  expect_alike("fix rigid against the engine", difference(rigid, other, kPlane), 0.01, 0.02);
}

// fix gravity weighs the spheres, whatever the file of fix rigid says: a clump fell too fast by
// what its spheres share.
TEST_F(FlatClump, OfRigidWhoseDiscsWeighOtherwiseIsRefused) {
  test::expect_end(couple(kLiggghts + " -in in.liggghts", "out", 1.01), 2,
                   {"fix gravity weighs the spheres of fix move rigid", "body 1 have 0.0064680",
                    "give the spheres densities with which both agree"});
}

}  // namespace
