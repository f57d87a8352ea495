// SPDX-License-Identifier: GPL-2.0-or-later
/// Clumps of LIGGGHTS in the fluid: those of fix multisphere and of fix rigid.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <fstream>
#include <map>
#include <sstream>
#include <string>
#include <vector>

#include "tests/support/coupled_job.h"

namespace {

using test::JobResult;
using test::kLbm;
using test::kLiggghts;
using test::mpirun;

constexpr const char* kScene = R"(title = "clump"
[box]
size = [0.012, 0.012, 0.018]
[fluid]
density = 1000.0
kinematic_viscosity = 1e-5
gravity = [0.0, 0.0, -9.81]
velocity_scale = 0.1
[particles]
diameter = 0.003
density = 1000.0
contact_stiffness = 1.0e3
[numerics]
cell = 0.0005
[coupling]
timeout = 30.0
[output]
probe_every = 0.005
[run]
end_time = 0.05
)";

constexpr const char* kScript = R"(atom_style granular
atom_modify map array sort 0 0
boundary ${boundary_x} ${boundary_y} ${boundary_z}
newton off
communicate single vel yes
processors PROCESSORS
units si
region domain block ${x_lo} ${x_hi} ${y_lo} ${y_hi} ${z_lo} ${z_hi} units box
if "${restart} == 1" then "read_restart ${restart_file}" else "create_box 1 domain"
neighbor 0.0005 bin
neigh_modify delay 0
fix m1 all property/global youngsModulus peratomtype 5.e6
fix m2 all property/global poissonsRatio peratomtype 0.45
fix m3 all property/global coefficientRestitution peratomtypepair 1 0.3
fix m4 all property/global coefficientFriction peratomtypepair 1 0.5
pair_style gran model hertz tangential history
pair_coeff * *
timestep ${solid_step}
fix x all wall/gran model hertz tangential history primitive type 1 xplane ${x_lo}
fix X all wall/gran model hertz tangential history primitive type 1 xplane ${x_hi}
fix y all wall/gran model hertz tangential history primitive type 1 yplane ${y_lo}
fix Y all wall/gran model hertz tangential history primitive type 1 yplane ${y_hi}
fix z all wall/gran model hertz tangential history primitive type 1 zplane ${z_lo}
fix Z all wall/gran model hertz tangential history primitive type 1 zplane ${z_hi}
BODIES
if "${restart} == 0" then "run 1"
fix weight all gravity ${gravity} vector 0.0 0.0 -1.0
fix fluid all lbm/couple every ${substeps}
run ${solid_steps_total}
)";

/// Two spheres 1 mm apart, one body of fix multisphere.
std::string multisphere(const std::string& density, const std::string& velocity = "0. 0. 0.") {
  return "fix one all particletemplate/multisphere 15485863 atom_type 1 density constant " +
         density +
         " nspheres 2 ntry 1000000 spheres file two.txt scale 0.001 type 1\n"
         "fix all_of all particledistribution/discrete 32452843 1 one 1.0\n"
         "region middle block 0.0055 0.0065 0.0055 0.0065 0.0085 0.0095 units box\n"
         "if \"${restart} == 0\" then \"fix put all insert/pack seed 32452867 distributiontemplate "
         "all_of insert_every once overlapcheck yes all_in no vel constant " +
         velocity +
         " region middle particles_in_region 1\"\n"
         "fix move all multisphere";
}

class Clumps : public testing::Test {
 protected:
  Clumps() { folder_.write("two.txt", "-0.5 0 0 1.5\n0.5 0 0 1.5\n"); }

  JobResult run(const std::string& bodies, const std::string& scene = kScene, int fluids = 1,
                int solids = 1, const std::string& options = "--out out") {
    folder_.write("scene.toml", scene);
    std::string script = test::replaced(kScript, "BODIES", bodies);
    script = test::replaced(script, "PROCESSORS", solids == 1 ? "1 1 1" : "1 1 2");
    folder_.write("in.liggghts", script);
    return test::run(mpirun({kLbm + " --progress none " + options, fluids},
                            {kLiggghts + " -in in.liggghts", solids}),
                     folder_.path(), 100.0);
  }

  using Row = std::array<double, 17>;  // of probes.csv in three dimensions
  /// Rows of a particle, of the clump where the id is below −1.
  std::vector<Row> rows(const std::string& out, bool clump) const {
    std::ifstream file(folder_.path() + "/" + out + "/probes.csv");
    std::vector<Row> all;
    std::string line, number;
    std::getline(file, line);
    while (std::getline(file, line)) {
      std::istringstream numbers(line);
      Row row{};
      for (double& value : row) {
        std::getline(numbers, number, ',');
        value = std::stod(number);
      }
      if ((row[1] < -1.0) == clump) all.push_back(row);
    }
    return all;
  }

  test::TemporaryFolder folder_;
};

TEST_F(Clumps, OfMultisphereThatAreNeutralStayWhereTheyAre) {
  // Its density is the fluid's, and its volume that of its template: weight and buoyancy are equal
  // to round-off. Counted once a sphere it rose at 7 cm/s.
  const JobResult job = run(multisphere("1000"));
  test::expect_end(job, 100.0, 0, {});
  const auto path = rows("out", true);
  ASSERT_GT(path.size(), 5U);
  for (int axis = 2; axis < 5; ++axis)
    EXPECT_NEAR(path.back()[axis], path.front()[axis], 1e-6 * 0.003);
  EXPECT_EQ(rows("out", false).size(), 2 * path.size());
}

TEST_F(Clumps, FallAlikeOnAnyNumberOfRanks) {
  const std::string scene =
      test::replaced(kScene, "density = 1000.0\ncontact", "density = 2500.0\ncontact");
  test::expect_end(run(multisphere("2500"), scene), 100.0, 0, {});
  test::expect_end(run(multisphere("2500"), scene, 2, 2, "--out ranks"), 100.0, 0, {});
  const auto one = rows("out", true), many = rows("ranks", true);
  ASSERT_EQ(one.size(), many.size());
  ASSERT_GT(one.size(), 5U);
  EXPECT_LT(one.back()[4], one.front()[4] - 2e-4);  // it falls
  for (std::size_t k = 0; k < one.size(); ++k)
    for (std::size_t c = 2; c < 17;
         ++c)  // sums in another order: round-off that contacts do not see
      EXPECT_NEAR(one[k][c], many[k][c], 1e-9 * std::max(1e-3, std::abs(one[k][c])))
          << k << ' ' << c;
}

TEST_F(Clumps, TakeTheImpulseOfTheirLoads) {
  // A row has the state at its time and the load of the interval that ended there: over any number
  // of intervals m ΔU = Σ T F + m g t, with one mass in all three axes; Verlet's half-steps of the
  // load that changes from one interval to the next are made up for (ParticleCoupling).
  std::string scene =
      test::replaced(kScene, "density = 1000.0\ncontact", "density = 1500.0\ncontact");
  scene = test::replaced(scene, "probe_every = 0.005\n", "");
  scene = test::replaced(scene, "end_time = 0.05", "end_time = 0.01");
  test::expect_end(run(multisphere("1500", "0.05 0.03 0.0"), scene), 100.0, 0, {});
  const auto path = rows("out", true);
  ASSERT_GT(path.size(), 20U);
  const double interval = path[1][0] - path[0][0];
  std::array<double, 3> impulse{}, change{};
  for (std::size_t k = 3; k < path.size(); ++k)
    for (int a = 0; a < 3; ++a) {
      impulse[a] += interval * path[k][11 + a];
      change[a] += path[k][5 + a] - path[k - 1][5 + a];
    }
  const double time = interval * static_cast<double>(path.size() - 3);
  const double mass = impulse[0] / change[0];
  EXPECT_NEAR(impulse[1] / change[1] / mass, 1.0, 1e-6);
  EXPECT_NEAR(impulse[2] / (change[2] + 9.81 * time) / mass, 1.0, 1e-6);
  // two balls of 1.5 mm less their lens, by LIGGGHTS' samples
  EXPECT_NEAR(mass / (1500.0 * 2.0980e-8), 1.0, 0.005);
}

}  // namespace
