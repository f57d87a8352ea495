// SPDX-License-Identifier: GPL-2.0-or-later
/// Loads as physics: momentum to round-off, rest at equal density, symmetry, and the disc's
/// equation of motion with everything but LIGGGHTS in the loop.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "lbm_solver/coupling/particles.h"
#include "lbm_solver/solver/fluid.h"

namespace {

using namespace lbm;

const std::vector<SolidTerm> kTerms{SolidTerm::Resistance, SolidTerm::LayeredResistance,
                                    SolidTerm::NobleTorczynski, SolidTerm::Holdych,
                                    SolidTerm::LayeredHoldych};

Vec3 momentum(const Fluid& fluid) {
  const Domain& d = fluid.domain();
  Vec3 sum(0.0, 0.0);
  for (int y = 0; y < d.ny; ++y)
    for (int x = 0; x < d.nx; ++x)
      for (int q = 1; q < D2Q9::Q; ++q)
        sum += fluid.arriving(q, x, y) * Vec3(D2Q9::c[q][0], D2Q9::c[q][1]);
  return sum;
}

/// Momentum that the walls gave to the fluid in the last step: a population that came back from a
/// wall arrived as c_q and had left as -c_q.
Vec3 wall_impulse(const Fluid& fluid) {
  const Domain& d = fluid.domain();
  Vec3 sum(0.0, 0.0);
  for (int y = 0; y < d.ny; ++y)
    for (int x = 0; x < d.nx; ++x)
      for (int q = 1; q < D2Q9::Q; ++q) {
        const int from_x = x - D2Q9::c[q][0], from_y = y - D2Q9::c[q][1];
        const bool beyond_x = d.x == Side::Wall && (from_x < 0 || from_x >= d.nx);
        const bool beyond_y = d.y == Side::Wall && (from_y < 0 || from_y >= d.ny);
        if (beyond_x || beyond_y)
          sum += 2.0 * fluid.arriving(q, x, y) * Vec3(D2Q9::c[q][0], D2Q9::c[q][1]);
      }
  return sum;
}

TEST(Momentum, FluidPlusDiscsMinusWallsIsConstant) {
  for (const SolidTerm term : kTerms)
    for (const Side side : {Side::Wall, Side::Periodic}) {
      const Domain domain{50, 44, side, Side::Wall};
      Fluid fluid(domain, {.solid_term = term, .parameters = {.tau = 0.7}});
      std::vector<Body> discs{{1, {20.2, 30.1}, 6.0, {0.03, -0.04}, 0.002},
                              {2, {29.0, 25.0}, 4.0, {-0.02, 0.01}, -0.001},
                              {3, {1.0, 3.0}, 5.0, {0.0, 0.02}, 0.0}};
      for (int step = 0; step < 60; ++step) {
        fluid.place(discs);
        const Vec3 before = momentum(fluid);
        fluid.step();
        Vec3 on_discs(0.0, 0.0);
        for (const auto& load : fluid.momentary_loads()) on_discs += load.force;
        const Vec3 residual = momentum(fluid) - before + on_discs - wall_impulse(fluid);
        // 2200 cells times nine populations of 1e-3 … 1e-2: round-off of the sums, relative to the
        // force
        EXPECT_LT(residual.norm(), 1e-12 * std::max(1.0, on_discs.norm())) << term << ' ' << step;
        for (Body& d : discs) d.centre += d.velocity;
      }
    }
}

TEST(Symmetry, AMirroredSceneGivesMirroredLoads) {
  const Domain domain{48, 40, Side::Wall, Side::Wall};
  const auto run = [&](double sign) {
    Fluid fluid(domain, {.solid_term = SolidTerm::LayeredResistance, .parameters = {.tau = 0.8}});
    Body disc{1, {24.0 + sign * 5.25, 18.5}, 5.5, {sign * 0.03, -0.02}, sign * 0.004};
    BodyLoad load;
    for (int s = 0; s < 40; ++s) {
      fluid.place(std::vector{disc});
      fluid.step();
      load = fluid.loads()[0];
      disc.centre += disc.velocity;
    }
    return load;
  };
  const BodyLoad right = run(1.0), left = run(-1.0);
  EXPECT_NEAR(right.force.x(), -left.force.x(), 1e-12);
  EXPECT_NEAR(right.force.y(), left.force.y(), 1e-12);
  EXPECT_NEAR(right.torque.z(), -left.torque.z(), 1e-11);
  EXPECT_LT(right.force.x(), -1e-3);   // drag opposes the motion
  EXPECT_LT(right.torque.z(), -1e-3);  // and the rotation
}

/// A rigid disc as a solid program integrates it: velocity Verlet with the load of the interval.
struct FreeDisc {
  protocol::Particle p;
  double gravity;
  double interval;

  void advance(const protocol::Load& load) {
    const double ay = load.force[1] / p.shape.mass + gravity;
    const double ax = load.force[0] / p.shape.mass;
    p.state.x[0] += interval * (p.state.v[0] + 0.5 * interval * ax);
    p.state.x[1] += interval * (p.state.v[1] + 0.5 * interval * ay);
    p.state.v[0] += interval * ax;
    p.state.v[1] += interval * ay;
    p.state.omega[2] += interval * load.torque[2] / p.shape.inertia;
  }
};

FreeDisc settle(double density_ratio, int steps, bool inner_inertia) {
  const double diameter = 0.0025, radius = 0.5 * diameter, dx = diameter / 10;
  const Units units{dx, 4e-4, 1000.0, 1.0, {0.0, 0.0}};
  const FluidScene fluid_scene{
      .density = 1000.0, .viscosity = 1e-5, .gravity = {0.0, -9.8}, .velocity_scale = 0.06};
  CouplingScene coupling;
  coupling.inner_inertia = inner_inertia;
  const double tau = 0.5 + 3.0 * fluid_scene.viscosity * units.dt / (dx * dx);
  Fluid fluid({80, 160, Side::Wall, Side::Wall},
              {.solid_term = SolidTerm::LayeredResistance, .parameters = {.tau = tau}});
  Scene scene;
  scene.fluid = fluid_scene;
  scene.coupling = coupling;
  scene.particles.emplace();
  Particles particles(units, scene, fluid.domain(), SolidTerm::LayeredResistance);
  const double mass = density_ratio * 1000.0 * std::numbers::pi * radius * radius;
  FreeDisc disc{
      {{1, {0.01, 0.03, 0.0}, {}, {}}, {1, radius, mass, 0.5 * mass * radius * radius, 1}},
      -9.8,
      units.dt};
  for (int s = 0; s < steps; ++s) {
    particles.arrive(std::vector{disc.p}, units.dt);
    fluid.place(particles.bodies(0.0));
    fluid.step();
    particles.add(fluid.loads());
    disc.advance(particles.mean_loads(1)[0]);
  }
  return disc;
}

TEST(FreeDisc, OfTheFluidsDensityStaysAtRest) {
  const FreeDisc disc = settle(1.0, 2000, true);
  EXPECT_NEAR(disc.p.state.v[0], 0.0, 1e-10);
  EXPECT_NEAR(disc.p.state.v[1], 0.0, 1e-10);
  EXPECT_NEAR(disc.p.state.x[1], 0.03, 1e-10);
}

TEST(FreeDisc, FallsLessFarWithoutTheInertiaOfTheFluidInside) {
  const double with = 0.03 - settle(1.25, 500, true).p.state.x[1];  // 0.2 s
  const double without = 0.03 - settle(1.25, 500, false).p.state.x[1];
  // The extra mass 0.8 of its own delays the start by 5.6 % at 0.4 s, by more at 0.2 s.
  EXPECT_GT(1.0 - without / with, 0.05);
  EXPECT_LT(1.0 - without / with, 0.25);
}

}  // namespace
