// SPDX-License-Identifier: GPL-2.0-or-later
/// Meshes that move as they are told: flows with known answers. Blocks in two dimensions are meshes
/// too, through the one layer of cells.
#include <gtest/gtest.h>
#include <omp.h>

#include <cmath>
#include <numbers>

#include "lbm_solver/immersed/geometry.h"
#include "lbm_solver/solver/fluid.h"
#include "tests/support/flux.h"
#include "tests/support/meshes.h"

namespace {

using namespace lbm;
using std::numbers::pi;
using test::flux;

KernelChoice choice(int dimension, double tau, const Vec3& force = Vec3()) {
  KernelChoice c{.force = force.norm() > 0.0,
                 .solid_term = SolidTerm::LayeredResistance,
                 .parameters = {.tau = tau,
                                .magic = kResistanceMagic,
                                .force_x = force.x(),
                                .force_y = force.y(),
                                .force_z = force.z()}};
  c.lattice = dimension == 2 ? VelocitySet::D2Q9 : VelocitySet::D3Q19;
  return c;
}

MeshSolid solid(TriangleMesh mesh, bool hollow = false) {
  return {std::make_shared<const TriangleMesh>(std::move(mesh)), hollow};
}

/// A block in two dimensions.
MeshSolid block(const Vec3& low, const Vec3& high) {
  return solid(test::box_mesh({low.x(), low.y(), -1.0}, {high.x(), high.y(), 2.0}));
}

/// Flux that a body force drives past a block in a periodic box, seen from a frame in which the
/// block moves, added to its velocity; and the load on it over the drive.
struct Driven {
  Vec3 flux;
  double load_over_drive;
};
Driven driven(const Vec3& velocity, double angle) {
  const Domain box{24, 24, Side::Periodic, Side::Periodic};
  const Vec3 g(2e-6, 0.0), middle(12.3, 11.8);
  Fluid fluid(box, choice(2, 0.8, g));
  fluid.add(solid(test::turned(test::box_mesh({8.3, 9.3, -1.0}, {16.3, 14.3, 2.0}), middle,
                               {0, 0, 1}, angle)),
            [=](std::int64_t step) {
              Pose pose;
              pose.pivot = middle;
              pose.shift = static_cast<double>(step) * velocity;
              pose.velocity = velocity;
              return pose;
            });
  for (int y = 0; y < box.ny; ++y)
    for (int x = 0; x < box.nx; ++x) fluid.set_equilibrium(x, y, 1.0, velocity);
  const int steps = 3600, last = 1200;  // a way through the box
  Vec3 sum = Vec3::Zero(), load = Vec3::Zero();
  for (int step = 0; step < steps; ++step) {
    fluid.advance(1);
    if (step < steps - last) continue;
    sum += flux(fluid) / last;
    load += fluid.fixed_loads()[0].force / last;
  }
  return {sum - velocity, load.x() / (g.x() * box.nx * box.ny)};
}

// Half of the error is that of the place in the cells, which a block that moves averages.
TEST(MovingWall, ABlockThatMovesSeesTheFlowOfOneAtRest) {
  for (const double angle : {0.0, 0.5}) {
    const Driven rest = driven({0.0, 0.0}, angle);
    for (const Vec3& velocity : {Vec3(-0.02, 0.0), Vec3(0.012, 0.017)}) {
      const Driven moving = driven(velocity, angle);
      std::printf("block at %.1f rad, velocity (%.3f, %.3f): flux %+.2f %%, load %+.2f %%\n", angle,
                  velocity.x(), velocity.y(), 100.0 * (moving.flux.x() / rest.flux.x() - 1.0),
                  100.0 * (moving.load_over_drive - 1.0));
      EXPECT_NEAR(moving.flux.x() / rest.flux.x(), 1.0, 0.01);
      EXPECT_NEAR(moving.load_over_drive, 1.0, 0.005);
    }
  }
}

/// Torque on a cylinder (radius 8) that turns in one at rest (16), over Taylor and Couette's
/// 4π μ ω R₁² R₂² / (R₂² - R₁²) a length; and the largest step of it over the mean.
double couette_torque(int sides, bool surface_only, double& noise) {
  const double r1 = 8.0, r2 = 16.0, w = 0.005, tau = 0.8, nu = (tau - 0.5) / 3.0;
  const Domain box{36, 36, Side::Wall, Side::Wall};
  const Vec3 middle(18.21, 17.83);
  const auto cylinder = [&](double r, int n) {  // of the area of the circle
    const double polygon = r * std::sqrt(2.0 * pi / (n * std::sin(2.0 * pi / n)));
    return test::cylinder_mesh(middle + Vec3(0, 0, -200), middle + Vec3(0, 0, 200), polygon, n);
  };
  Fluid fluid(box, choice(2, tau));
  fluid.add({solid(cylinder(r2, 128), true)});
  const auto turned = [=](std::int64_t step) {
    Pose pose;
    pose.pivot = middle;
    pose.angle = surface_only ? 0.0 : w * static_cast<double>(step);
    pose.spin = {0.0, 0.0, w};
    return pose;
  };
  fluid.add(solid(cylinder(r1, sides)), turned);
  fluid.advance(3000);
  const int steps = 400;
  std::vector<double> torques;
  double mean = 0.0;
  for (int step = 0; step < steps; ++step) {
    fluid.advance(1);
    torques.push_back(-fluid.fixed_loads()[1].torque.z());
    mean += torques.back() / steps;
  }
  noise = 0.0;
  for (const double t : torques) noise = std::max(noise, std::abs(t / mean - 1.0));
  return mean / (4.0 * pi * nu * w * r1 * r1 * r2 * r2 / (r2 * r2 - r1 * r1));
}

// A disc of sixteen cells has a torque that is half a per cent too large (resistance.md).
TEST(MovingWall, ACylinderHasTheTorqueOfTaylorAndCouette) {
  for (const bool surface_only : {true, false}) {
    double noise = 0.0;
    const double ratio = couette_torque(64, surface_only, noise);
    std::printf("cylinder of 64 sides, %s: torque %+.2f %%, largest deviation %.2f %%\n",
                surface_only ? "its surface only" : "turned", 100.0 * (ratio - 1.0), 100.0 * noise);
    EXPECT_NEAR(ratio, 1.0, 0.015);
    EXPECT_LT(noise, 0.02);
  }
}

// A drum spins its fluid up until all of it turns with it, and no torque is left. On the way the
// torque is what the fluid inside gains. Its outer half stands, and with it the fluid around.
TEST(MovingWall, ADrumTakesItsFluidAlong) {
  const double r = 12.0, wall = 10.0, w = 0.001;  // errors go with Ma²
  const Domain box{52, 52, Side::Wall, Side::Wall};
  const Vec3 middle(26.2, 25.9), up(0.0, 0.0, 200.0);
  Fluid fluid(box, choice(2, 0.8));
  TriangleMesh inside = test::cylinder_mesh(middle - up, middle + up, r, 128);
  for (auto& [a, b, c] : inside.triangles) std::swap(b, c);
  const TriangleMesh outside = test::cylinder_mesh(middle - up, middle + up, r + wall, 128);
  fluid.add(
      solid(test::together({outside, inside})),
      [=](std::int64_t) {
        Pose pose;
        pose.pivot = middle;
        pose.spin = {0.0, 0.0, w};
        return pose;
      },
      r + 0.6 * wall, true);
  const auto spin = [&] {  // angular momentum of the fluid, and its mean over that of the drum
    double sum = 0.0, ratio = 0.0, count = 0.0;
    for (int y = 0; y < box.ny; ++y)
      for (int x = 0; x < box.nx; ++x) {
        const Vec3 arm(x + 0.5 - middle.x(), y + 0.5 - middle.y()), u = fluid.cell(x, y).u;
        const double turn = arm.x() * u.y() - arm.y() * u.x();
        if (arm.norm() < r + 1.0) sum += (1.0 - fluid.solid_fraction(x, y)) * turn;
        if (arm.norm() > 2.0 && arm.norm() < r - 2.0) {
          ratio += turn / (w * arm.squaredNorm());
          ++count;
        }
      }
    return std::pair{sum, ratio / count};
  };
  fluid.advance(50);
  const double before = spin().first;
  double impulse = 0.0;
  for (int step = 0; step < 100; ++step) {
    fluid.advance(1);
    impulse -= fluid.fixed_loads()[0].torque.z();
  }
  const double gain = spin().first - before, first_torque = fluid.fixed_loads()[0].torque.z();
  fluid.advance(8000);
  const double last_torque = fluid.fixed_loads()[0].torque.z();
  std::printf(
      "drum: impulse over gain %+.2f %%, fluid turns at %.5f of it, torque %.2g of the first\n",
      100.0 * (impulse / gain - 1.0), spin().second, last_torque / first_torque);
  EXPECT_NEAR(impulse / gain, 1.0, 0.02);
  EXPECT_NEAR(spin().second, 1.0, 0.002);
  EXPECT_LT(std::abs(last_torque / first_torque), 0.005);
}

/// Velocity over a plate that oscillates along itself, against Stokes's second problem
/// U e^(-ky) cos(ωt - ky), k = √(ω/2ν): the largest difference over U. And the amplitude of the
/// stress over μ U k √2. The load holds what moves the fluid inside of the plate.
struct Stokes {
  double velocity, stress;
};
Stokes oscillating_plate(bool surface_only) {
  const double tau = 0.8, nu = (tau - 0.5) / 3.0, period = 2000.0, w = 2.0 * pi / period;
  const double amplitude = 6.0, speed = w * amplitude, k = std::sqrt(w / (2.0 * nu));
  const Domain box{16, 100, Side::Periodic, Side::Wall};
  const double bottom = 43.12, top = 56.37;  // the walls are five and a half times 1/k away
  Fluid fluid(box, choice(2, tau));
  const auto shift = [=](double t) { return amplitude * std::sin(w * t); };
  // the box repeats it without an end
  const auto pose_at_step = [=](std::int64_t step) {
    Pose pose;
    pose.pivot = {8.0, 50.0};
    const auto t = static_cast<double>(step);
    if (!surface_only) pose.shift = {shift(t), 0.0};
    pose.velocity = {speed * std::cos(w * t), 0.0};
    return pose;
  };
  fluid.add(block({0.0, bottom}, {16.0, top}), pose_at_step);
  Stokes worst{0.0, 0.0};
  double along = 0.0, across = 0.0;  // parts of the stress with the velocity and before it
  const int first = 6000, steps = 2000;
  fluid.advance(first);
  for (int step = first; step < first + steps; ++step) {
    for (int y = 57; y < 90; ++y) {
      const double d = y + 0.5 - top;
      const double exact = speed * std::exp(-k * d) * std::cos(w * step - k * d);
      worst.velocity = std::max(worst.velocity, std::abs(fluid.cell(7, y).u.x() - exact) / speed);
    }
    fluid.advance(1);
    const double t = step + 0.5, inner = box.nx * (top - bottom) * speed *
                                         (std::cos(w * (step + 1.0)) - std::cos(w * step));
    const double stress = (fluid.fixed_loads()[0].force.x() + inner) / (2 * box.nx);
    along += 2.0 / steps * stress * std::cos(w * t);
    across += 2.0 / steps * stress * std::sin(w * t);
  }
  worst.stress = std::hypot(along, across) / (nu * speed * k * std::numbers::sqrt2);
  std::printf("phase of the stress %.2f degrees (45)\n", std::atan2(across, -along) * 180.0 / pi);
  return worst;
}

TEST(MovingWall, APlateThatOscillatesDragsTheFluidAsStokesSays) {
  for (const bool surface_only : {true, false}) {
    const Stokes plate = oscillating_plate(surface_only);
    std::printf("plate, %s: velocity off by %.2f %% of its own, stress %+.2f %%\n",
                surface_only ? "its surface only" : "moved", 100.0 * plate.velocity,
                100.0 * (plate.stress - 1.0));
    EXPECT_LT(plate.velocity, 0.01);
    EXPECT_NEAR(plate.stress, 1.0, 0.015);
  }
}

// What a gate sweeps goes past it: through the gaps at its height flows its width times its speed.
TEST(MovingWall, AGateThatClosesDisplacesItsVolume) {
  const Domain box{40, 60, Side::Wall, Side::Wall};
  const double speed = 0.01, left = 12.3, right = 25.9;
  Fluid fluid(box, choice(2, 0.8));
  fluid.add(block({left, 35.0}, {right, 55.0}), [=](std::int64_t step) {
    Pose pose;
    pose.shift = {0.0, -speed * static_cast<double>(step)};
    pose.velocity = {0.0, -speed};
    return pose;
  });
  for (const int steps : {1000, 1200, 700}) {
    fluid.advance(steps);
    const int row = 45 - static_cast<int>(speed * static_cast<double>(fluid.steps()));
    double up = 0.0;
    for (int x = 0; x < box.nx; ++x)
      up += (1.0 - fluid.solid_fraction(x, row)) * fluid.cell(x, row).u.y();
    std::printf("gate after %lld steps: flow past it %+.2f %% of what it sweeps\n",
                static_cast<long long>(fluid.steps()),
                100.0 * (up / (speed * (right - left)) - 1.0));
    EXPECT_NEAR(up / (speed * (right - left)), 1.0, 0.02);
  }
}

/// What the fluid on one side of a plate loses in a step to the other, over what lies there, where
/// more of pressure stands on that side; and the change of all mass in the box, over that.
enum class Moves { No, Yes, SurfaceOnly };
struct Leak {
  double through, of_all;
};
Leak leak(Moves moves, double thickness, double more = 0.05) {
  const Domain box{40, 12, Side::Wall, Side::Wall};
  const double middle = 20.0, speed = 0.01;
  Fluid fluid(box, choice(2, 0.8));
  // beyond the box at both ends, from which it is drawn through it
  const MeshSolid plate =
      block({middle - 0.5 * thickness, -20.0}, {middle + 0.5 * thickness, 30.0});
  const bool shifts = moves == Moves::Yes;
  if (moves == Moves::No)
    fluid.add({plate});
  else
    fluid.add(
        plate,
        [=](std::int64_t step) {
          Pose pose;
          pose.velocity = {0.0, speed};
          if (shifts) pose.shift = {0.0, speed * static_cast<double>(step)};
          return pose;
        },
        {}, !shifts);
  fluid.move_shapes();
  for (int y = 0; y < box.ny; ++y)
    for (int x = 0; x < box.nx; ++x)
      if (x < middle && fluid.solid_fraction(x, y) < 1.0)
        fluid.set_equilibrium(x, y, 1.0 + more, Vec3());
  const auto mass = [&](double end) {
    double sum = 0.0;
    for (int y = 0; y < box.ny; ++y)
      for (int x = 0; x < end; ++x) sum += fluid.cell(x, y).rho;
    return sum;
  };
  const double all = mass(box.nx);
  const int threads = omp_get_max_threads();
  omp_set_num_threads(1);  // a box so small waits for its threads only
  fluid.advance(500);
  const double before = mass(middle);
  fluid.advance(1000);
  omp_set_num_threads(threads);
  return {std::abs(mass(middle) - before) / before / 1000.0, std::abs(mass(box.nx) / all - 1.0)};
}

// Closed is a layer at rest in which one cell is covered whole everywhere: it reflects all that
// arrives. (From five cells on, what it holds for a step is on its own side.) So does the deepest
// layer of a wall that moves along itself at one velocity, from eleven cells on.
TEST(MovingWall, LetsNothingThroughButWhereItMovesThroughTheCells) {
  for (const double thickness : {2.0, 3.0, 5.0})
    EXPECT_LT(leak(Moves::No, thickness).through, 1e-12) << thickness;
  EXPECT_LT(leak(Moves::SurfaceOnly, 11.0).through, 1e-12);
  EXPECT_GT(leak(Moves::No, 1.5).through, 1e-7);  // thin: no cell is covered whole
  for (const double thickness : {5.0, 9.0}) {
    const double moving = leak(Moves::Yes, thickness).through;
    std::printf("plate of %.0f cells that moves: %.2g of the mass a step\n", thickness, moving);
    EXPECT_LT(moving, 1e-5);
  }
}

// What passes a wall that moves through the cells is pressed through: in proportion to the
// difference of pressure, nothing without one. Cells that take up the motion of others forget a
// little of what they hold (resistance.md, Ringing); none of it is mass of cells that the wall
// enters or leaves, for the mass of the box stays what it is to round-off (a sum of 480 in 1500
// steps).
TEST(MovingWall, ThroughWhichSomeIsPressedLosesNoMass) {
  const Leak half = leak(Moves::Yes, 9.0, 0.025), whole = leak(Moves::Yes, 9.0, 0.05);
  std::printf("plate that moves: %.3g and %.3g of the mass a step at 1/40 and 1/20 more\n",
              half.through, whole.through);
  EXPECT_NEAR(whole.through / half.through, 2.0, 0.1);
  EXPECT_LT(leak(Moves::Yes, 9.0, 0.0).through, 1e-15);
  for (const Moves moves : {Moves::No, Moves::Yes, Moves::SurfaceOnly})
    EXPECT_LT(leak(moves, 11.0).of_all, 1e-13);
}

// The motion is a function of time alone: a run that goes on ends as the one that did not stop.
TEST(MovingWall, GoesOnToTheBitAfterARestart) {
  const Domain box{20, 20, Side::Periodic, Side::Periodic, 20, Side::Periodic};
  const auto fresh = [&] {
    Fluid fluid(box, choice(3, 0.8, {1e-6, 0.0, 0.0}));
    fluid.add(solid(test::box_mesh({5.3, 6.1, 4.2}, {12.0, 14.5, 13.0})), [](std::int64_t step) {
      Pose pose;
      pose.pivot = {8.0, 10.0, 9.0};
      pose.axis = Vec3(1, 2, 2) / 3.0;
      pose.angle = 0.004 * static_cast<double>(step);
      pose.spin = 0.004 * pose.axis;
      pose.shift = static_cast<double>(step) * Vec3(0.02, 0.0, -0.01);
      pose.velocity = {0.02, 0.0, -0.01};
      return pose;
    });
    return fluid;
  };
  Fluid whole = fresh(), first = fresh(), second = fresh();
  whole.advance(60);
  first.advance(27);
  second.load(first.save());
  second.advance(33);
  EXPECT_EQ(whole.fixed_loads()[0].force, second.fixed_loads()[0].force);
  EXPECT_EQ(whole.fixed_loads()[0].torque, second.fixed_loads()[0].torque);
  for (int z = 0; z < 20; ++z)
    for (int y = 0; y < 20; ++y)
      for (int x = 0; x < 20; ++x) ASSERT_EQ(whole.cell(x, y, z).u, second.cell(x, y, z).u);
  EXPECT_GT(whole.fixed_loads()[0].force.norm(), 0.0);
}

}  // namespace
