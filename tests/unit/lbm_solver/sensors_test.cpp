// SPDX-License-Identifier: GPL-2.0-or-later
/// Flow through a plane, forces on the sides, and averages, against what is known exactly.
#include <gtest/gtest.h>

#include <cmath>

#include "lbm_solver/base/errors.h"
#include "lbm_solver/coupling/field_average.h"
#include "lbm_solver/coupling/shown_cells.h"
#include "lbm_solver/io/scene_reader.h"
#include "lbm_solver/solver/plane_flow.h"
#include "lbm_solver/solver/side_loads.h"
#include "protocol/transport/hdf5_file.h"
#include "tests/support/job.h"

namespace {

using namespace lbm;

constexpr double kForce = 1e-6, kTau = 0.8, kViscosity = (kTau - 0.5) / 3.0;
constexpr int kHeight = 16, kLength = 5;

/// Flow between plates across y under a force along x, until it is steady; Λ = 3/16 puts the
/// plates exactly half-way.
Fluid poiseuille(Side x = Side::Periodic, int length = kLength) {
  KernelChoice choice{.force = true, .parameters = {.tau = kTau, .force_x = kForce}};
  Fluid fluid({length, kHeight, x, Side::Wall}, choice);
  fluid.advance(20000);
  return fluid;
}

CellBox column(int x) {
  return {{x, 0, 0}, {x + 1, kHeight, 1}};
}

/// Σ over the cells' centres of the parabola G y (H - y)/(2 ν).
TEST(PlaneFlow, OfAChannelIsTheParabolaInEveryColumn) {
  const Fluid fluid = poiseuille();
  double volume = 0.0, momentum = 0.0;
  for (int j = 0; j < kHeight; ++j) {
    const double y = j + 0.5, u = kForce * y * (kHeight - y) / (2.0 * kViscosity);
    volume += u;
    momentum += u * u;
  }
  for (int x = 0; x < kLength; ++x) {
    const PlaneFlow flow = PlaneFlow::of(fluid, column(x), 0);
    EXPECT_NEAR(flow.volume, volume, 1e-10 * volume) << x;
    EXPECT_NEAR(flow.momentum.x(), momentum, 1e-9 * momentum) << x;
    EXPECT_NEAR(flow.pressure, 0.0, 1e-12);
    EXPECT_EQ(flow.area, kHeight);
  }
  const PlaneFlow across = PlaneFlow::of(fluid, {{0, 7, 0}, {kLength, 8, 1}}, 1);
  EXPECT_NEAR(across.volume, 0.0, 1e-14);
}

// Past a block in a channel, where the force drives, the same flow passes every plane, through the
// block's sides too.
TEST(PlaneFlow, IsTheSameThroughEveryPlaneOfASteadyFlow) {
  KernelChoice choice{.force = true,
                      .solid_term = SolidTerm::Resistance,
                      .parameters = {.tau = kTau, .force_x = kForce}};
  Fluid fluid({12, kHeight, Side::Periodic, Side::Wall}, choice);
  fluid.add_wall({4, 4, 0}, {7, 9, 1});
  fluid.advance(20000);
  const double first = PlaneFlow::of(fluid, column(0), 0).volume;
  EXPECT_GT(first, 1e-5);
  for (int x = 1; x < 12; ++x)
    EXPECT_NEAR(PlaneFlow::of(fluid, column(x), 0).volume, first, 1e-9 * first) << x;
  EXPECT_EQ(PlaneFlow::of(fluid, column(5), 0).area, kHeight - 5);
  EXPECT_EQ(PlaneFlow::of(fluid, column(4), 0).area, kHeight - 2.5);  // half of it before the block
}

// Cells that are covered whole keep what they begin with, and turn it to and fro: with the half of
// a body force that belongs to the fluid the flow would change by that of their cells from step to
// step. A block, a disc, and for each term that reflects in them.
TEST(PlaneFlow, IsTheSameInEveryStepWhereABodyForceActsOnSolids) {
  const test::TemporaryFolder folder;
  for (const char* term : {"resistance", "layered_resistance", "holdych", "noble_torczynski"}) {
    const Scene scene = read_scene({folder.write("scene.toml", std::string(R"(
[box]
size = [0.03, 0.016]
sides_x = "periodic"
sides_y = "periodic"
[fluid]
density = 1000.0
kinematic_viscosity = 1e-5
body_force = [0.01, 0.0]
velocity_scale = 0.01
[numerics]
cell = 0.001
collision = "trt"
solid_term = ")") + term + R"("
[[obstacle]]
from = [0.002, 0.003]
to = [0.008, 0.010]
[[obstacle]]
centre = [0.019, 0.0082]
diameter = 0.009
[run]
end_time = 1.0
)")});
    const Plan plan = make_plan(scene);
    Fluid fluid = make_fluid(scene, plan);
    // at rest, where what is there lacks half of the force
    EXPECT_NEAR(PlaneFlow::of(fluid, {{18, 0, 0}, {19, 16, 1}}, 0).volume, 0.0, 1e-15) << term;
    EXPECT_NEAR(mean_arrived_momentum(fluid).x(), 0.0, 1e-15) << term;
    const double g = fluid.body_force().x();
    fluid.advance(4001);
    for (const int x : {4, 18}) {
      const CellBox plane{{x, 0, 0}, {x + 1, 16, 1}};
      const double before = PlaneFlow::of(fluid, plane, 0).volume;
      const double flux = mean_arrived_momentum(fluid).x();
      fluid.advance(1);
      EXPECT_NEAR(PlaneFlow::of(fluid, plane, 0).volume, before, 1e-3 * g) << term << ' ' << x;
      EXPECT_NEAR(mean_arrived_momentum(fluid).x(), flux, 1e-5 * g) << term;
      // the disc of Noble and Torczynski pumps mass on, so that its flow never is steady
      if (std::string(term) != "noble_torczynski") {
        EXPECT_NEAR(16 * flux, before, 1e-3 * g) << term << ' ' << x;
      }
    }
  }
}

// What drives the fluid is what the plates take, half each.
TEST(SideLoads, TakeWhatDrivesAChannel) {
  const Fluid fluid = poiseuille();
  const double half = 0.5 * kForce * kLength * kHeight;
  for (const SideName side : {SideName::Bottom, SideName::Top}) {
    const Vec3 force = SideLoads(fluid, side).force(fluid);
    EXPECT_NEAR(force.x(), half, 1e-9 * half);
    EXPECT_NEAR(force.y(), 0.0, 1e-9 * half);
  }
  EXPECT_EQ(SideLoads(fluid, SideName::Left).force(fluid), Vec3::Zero());  // periodic
}

// Closed on all sides the force only makes a pressure: left and right take all of it.
TEST(SideLoads, TakeThePressureOfAClosedBox) {
  // an even number of cells: an odd one has a mode that changes its sign at every step
  const Fluid fluid = poiseuille(Side::Wall, 8);
  const double drive = kForce * 8 * kHeight;
  Vec3 sum = Vec3::Zero();
  for (const SideName side : {SideName::Left, SideName::Right, SideName::Bottom, SideName::Top})
    sum += SideLoads(fluid, side).force(fluid);
  EXPECT_NEAR(sum.x(), drive, 1e-6 * drive);
  EXPECT_NEAR(sum.y(), 0.0, 1e-6 * drive);
  const Vec3 left = SideLoads(fluid, SideName::Left).force(fluid),
             right = SideLoads(fluid, SideName::Right).force(fluid);
  // Σ 3 G (distance from the middle) × c_s² a cell: the linear pressure pulls and presses alike
  EXPECT_NEAR(left.x(), right.x(), 1e-6 * drive);
  EXPECT_NEAR(left.x(), 0.5 * drive, 1e-6 * drive);
}

// A plate that moves with U drags the fluid along: ρ ν U/H a cell, and the resting one holds it.
TEST(SideLoads, OfAMovingPlateAreThoseOfCouetteFlow) {
  KernelChoice choice{.parameters = {.tau = kTau}};
  Fluid fluid({kLength, kHeight, Side::Periodic, Side::Wall}, choice);
  const double speed = 0.01;
  const Opening top = Opening::whole(fluid.domain(), SideName::Top);
  fluid.add(std::make_unique<VelocityPatch>(fluid.lattice(), fluid.links(top), Vec3(speed, 0, 0),
                                            false, top, InTime{}));
  fluid.advance(20000);
  const double shear = kViscosity * speed / kHeight * kLength;
  EXPECT_NEAR(SideLoads(fluid, SideName::Bottom).force(fluid).x(), shear, 1e-9 * shear);
  EXPECT_NEAR(SideLoads(fluid, SideName::Top).force(fluid).x(), -shear, 1e-9 * shear);
}

/// A scene with a box of 4 × 3 cells. @param sides  more keys of [box]
std::string small_box(const std::string& sides, const std::string& rest) {
  return "[box]\nsize = [0.04, 0.03]\n" + sides + R"([fluid]
density = 1000.0
kinematic_viscosity = 1e-4
velocity_scale = 0.01
[numerics]
cell = 0.01
[run]
end_time = 1.0
)" + rest;
}

/// That box, periodic, in a scene that averages from 0.25 s on.
class Average : public testing::Test {
 protected:
  Average()
      : scene_(read_scene({folder_.write(
            "scene.toml", small_box("sides_x = \"periodic\"\nsides_y = \"periodic\"\n",
                                    "[average]\nfrom = 0.25\n"))})),
        plan_(make_plan(scene_)),
        ranks_(plan_.domain),
        fluid_(make_fluid(scene_, plan_, ranks_)) {}

  void set(double u) {
    for (int y = 0; y < 3; ++y)
      for (int x = 0; x < 4; ++x) fluid_.set_equilibrium(x, y, 1.0 + u, {u, -u, 0.0});
  }
  std::vector<float> read(const char* name, std::size_t count) const {
    const auto file =
        protocol::hdf5::open_file(folder_.path() + "/averages.h5", protocol::hdf5::Open::Read);
    const protocol::hdf5::Handle set(H5Dopen2(file, name, H5P_DEFAULT), H5Dclose, name);
    std::vector<float> values(count);
    EXPECT_GE(H5Dread(set, H5T_NATIVE_FLOAT, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()), 0);
    return values;
  }

  const test::TemporaryFolder folder_;
  const Scene scene_;
  const Plan plan_;
  const Decomposition ranks_;
  Fluid fluid_;
};

TEST_F(Average, OfASteadyFieldIsTheFieldAndNothingDeviates) {
  FieldAverage average(*scene_.output.average, plan_, ranks_);
  set(0.01);
  for (int i = 0; i < 7; ++i) average.add(0.1 * i, fluid_);
  average.write(folder_.path(), plan_.units);
  const auto u = read("velocity_mean", 36), deviation = read("velocity_rms", 36);
  const double expected = fluid_.cell(1, 1).u.x() * plan_.units.velocity();
  for (std::size_t i = 0; i < 36; i += 3) {
    EXPECT_FLOAT_EQ(u[i], static_cast<float>(expected));
    EXPECT_EQ(u[i + 2], 0.0f);
    EXPECT_EQ(deviation[i], 0.0f);
  }
  for (const float p : read("pressure_rms", 12)) EXPECT_EQ(p, 0.0f);
}

// Of u and 3 u the mean is 2 u, and both deviate by u.
TEST_F(Average, OfTwoFieldsDeviatesByHalfTheirDifference) {
  FieldAverage average(*scene_.output.average, plan_, ranks_);
  set(0.001);
  average.add(0.1, fluid_);
  Record record = average.save();
  FieldAverage later(*scene_.output.average, plan_, ranks_);
  later.load(record);  // a run that goes on
  set(0.003);
  later.add(0.2, fluid_);
  later.write(folder_.path(), plan_.units);
  const double unit = plan_.units.velocity();
  const auto u = read("velocity_mean", 36), deviation = read("velocity_rms", 36);
  const auto p = read("pressure_mean", 12), pressure_deviation = read("pressure_rms", 12);
  for (std::size_t i = 0; i < 36; i += 3) {
    EXPECT_NEAR(u[i], 0.002 * unit, 1e-6 * unit * 0.002);  // single precision in the file
    EXPECT_NEAR(u[i + 1], -0.002 * unit, 1e-6 * unit * 0.002);
    EXPECT_NEAR(deviation[i], 0.001 * unit, 1e-6 * unit * 0.002);
    EXPECT_NEAR(p[i / 3], 0.002 * plan_.units.pressure(), 1e-6 * plan_.units.pressure() * 0.002);
    EXPECT_NEAR(pressure_deviation[i / 3], 0.001 * plan_.units.pressure(),
                1e-6 * plan_.units.pressure() * 0.002);
  }
  EXPECT_THROW(later.load(Record()), std::invalid_argument);
}

TEST_F(Average, BeginsAtItsTime) {
  const FieldAverage average(*scene_.output.average, plan_, ranks_);
  const std::int64_t first = first_state(0.25, plan_.interval());
  EXPECT_GT(first, 1);
  EXPECT_FALSE(average.due(first - 1));
  EXPECT_TRUE(average.due(first));
  EXPECT_EQ(average.next(0), first);
}

/// A scene with one sensor.
std::string refusal(const std::string& sensor) {
  const test::TemporaryFolder folder;
  const std::string file = folder.write("scene.toml", small_box("", sensor));
  try {
    make_plan(read_scene({file}));
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(SensorScene, IsRefusedWhereItMeansNothing) {
  const auto refused = [](const std::string& sensor, const std::string& because) {
    EXPECT_NE(refusal(sensor).find(because), std::string::npos) << refusal(sensor);
  };
  const std::string plane = "[[sensor]]\nname = \"a\"\nkind = \"plane\"\naxis = \"x\"\nat = 0.02\n";
  EXPECT_EQ(refusal(plane), "");
  refused(plane + plane, "is the name of two sensors");
  refused(plane + "from = [0.0, 0.02]\nto = [0.04, 0.01]\n", "is empty: from 0.02 to 0.01 m in y");
  refused("[[sensor]]\nkind = \"plane\"\n", "name is missing");
  refused("[[sensor]]\nname = \"a/b\"\nkind = \"plane\"\n", "cannot name a file");
  refused("[[sensor]]\nname = \"a\"\nkind = \"plane\"\naxis = \"x\"\nat = 0.05\n", "0.05");
  refused("[[sensor]]\nname = \"a\"\nkind = \"line\"\nfrom = [0.0, 0.0]\nto = [0.0, 0.1]\n",
          "[0, 0.1] lies outside the box");
  refused("[[sensor]]\nname = \"a\"\nkind = \"side\"\nside = \"back\"\n", "back");
  refused("[average]\nfrom = 1.0\n", "is not before the end at 1 s");
  refused("[output]\nprobe_particles = [1.5]\n", "which is no particle's number");
}

}  // namespace
