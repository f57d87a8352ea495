// SPDX-License-Identifier: GPL-2.0-or-later
/// Discs that move freely, coupled as the programs are: release, light discs, periodic sides,
/// noise, the viscosity of a suspension.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "tests/support/array_references.h"
#include "tests/support/bodies_in_flow.h"
#include "tests/support/free_disc.h"
#include "tests/support/openings.h"
#include "tests/support/scheme_fluid.h"

namespace {

using namespace lbm;
using test::Case, test::FreeRun, test::make;

/// A disc that a solid program would integrate, released from rest in a closed box.
struct Released {
  double early_acceleration = 0.0;  ///< mean over the first `early` seconds
  double velocity = 0.0;            ///< at the end
  double noise = 0.0;               ///< largest change of force in a step over the weight, late
};

/// @param cells  across the disc; the step follows, so that the Mach number is the same
Released release(double ratio, double viscosity, double seconds, double early,
                 std::optional<double> virtual_mass = {}, int cells = 10) {
  const double diameter = 0.0025, radius = 0.5 * diameter, dx = diameter / cells, dt = 1e-3 / cells;
  const Units units{dx, dt, 1000.0, 1.0, {0.0, 0.0}};
  Scene scene;
  scene.fluid = {.density = 1000.0, .viscosity = viscosity, .gravity = {0.0, -9.8}};
  scene.coupling.emplace().virtual_mass = virtual_mass;
  scene.particles.emplace();
  Fluid fluid = make(SolidTerm::LayeredResistance, {8 * cells, 16 * cells, Side::Wall, Side::Wall},
                     CollisionOperator::Trt, 0.5 + 3.0 * viscosity * dt / (dx * dx));
  Particles particles(units, scene, fluid.domain(), SolidTerm::LayeredResistance);
  const double mass = ratio * 1000.0 * std::numbers::pi * radius * radius;
  protocol::Particle p{{1, {0.01, 0.02, 0.0}, {}, {}},
                       {1, radius, mass, 0.5 * mass * radius * radius, 1}};
  Released result;
  double last = 0.0;
  const int steps = static_cast<int>(seconds / dt), early_steps = static_cast<int>(early / dt);
  for (int s = 1; s <= steps; ++s) {
    particles.arrive(std::vector{p}, dt);
    fluid.place(particles.bodies(0.0));
    fluid.step();
    particles.add(fluid.loads());
    const auto load = particles.mean_loads(1)[0];
    for (int k = 0; k < 2; ++k) {
      const double a = load.force[k] / mass + scene.fluid.gravity[k];
      p.state.x[k] += dt * (p.state.v[k] + 0.5 * dt * a);
      p.state.v[k] += dt * a;
    }
    p.state.omega[2] += dt * load.torque[2] / p.shape.inertia;
    if (s == early_steps) result.early_acceleration = p.state.v[1] / early;
    if (s > steps / 2)
      result.noise = std::max(result.noise, std::abs(load.force[1] - last) / (mass * 9.8));
    last = load.force[1];
  }
  result.velocity = p.state.v[1];
  return result;
}

TEST(Release, StartsWithTheAddedMassOfADisc) {
  // a = (ρ_r - 1) g / (ρ_r + 1) within 15 %: sound takes 4 steps across the disc, and a boundary
  // layer of √(νt) = 0.1 mm adds 15 % of the displaced mass at 10 ms.
  for (const double ratio : {2.0, 0.5}) {
    const double exact = -(ratio - 1.0) * 9.8 / (ratio + 1.0);
    EXPECT_NEAR(release(ratio, 1e-6, 0.01, 0.01).early_acceleration / exact, 1.0, 0.15) << ratio;
  }
}

TEST(LightParticles, RiseSteadilyDownToATenthOfTheFluidsDensity) {
  double slower = 0.0;
  for (const double ratio : {0.9, 0.75, 0.5, 0.25, 0.1}) {
    const Released r = release(ratio, 1e-5, 0.1, 0.01);
    EXPECT_GT(r.velocity, slower) << ratio;  // the lighter the faster …
    // … but not faster than without any drag, by its weight and its added mass
    EXPECT_LT(r.velocity, (1.0 - ratio) / (1.0 + ratio) * 9.8 * 0.1) << ratio;
    slower = r.velocity;
    EXPECT_LT(r.noise, 0.1) << ratio;  // measured: 0.04 at a tenth
  }
}

TEST(LightParticles, RiseAsFastWithTwiceTheCells) {
  const double coarse = release(0.25, 1e-5, 0.1, 0.01).velocity;
  EXPECT_NEAR(coarse / release(0.25, 1e-5, 0.1, 0.01, {}, 20).velocity, 1.0, 0.02);
}

TEST(LightParticles, VirtualMassDoesNotChangeTheMotion) {
  // 0.5: where the plain coupling is still stable. 0.2 %: a lag of a few steps in 0.1 s.
  const double with = release(0.5, 1e-5, 0.1, 0.01, 2.0).velocity;
  const double without = release(0.5, 1e-5, 0.1, 0.01, 0.0).velocity;
  EXPECT_NEAR(with / without, 1.0, 0.002);
}

/// A free disc in a fluid at rest; see test::free_run.
FreeRun free_run(const Domain& domain, const Case& c, CollisionOperator collision, double tau,
                 double ratio, double radius, const Vec3& start, const Vec3& gravity, int steps,
                 int fluid_steps = 1) {
  Scene scene;
  scene.fluid = {.density = 1.0, .viscosity = (tau - 0.5) / 3.0, .gravity = gravity};
  scene.coupling.emplace();
  scene.particles.emplace();
  Fluid fluid = make(c, domain, collision, tau);
  return test::free_run(fluid, scene,
                        {.ratio = ratio,
                         .radius = radius,
                         .start = start,
                         .steps = steps,
                         .fluid_steps = fluid_steps,
                         .solid_term = c.term});
}

/// A disc in each period of a square array (c = 0.2) that its weight moves at Re_D = 0.1, the fluid
/// driven against it as hard: error of its drag, which is the weight, by its speed against the
/// flux.
double free_drag_error(int cells, double ratio) {
  const double tau = 1.0, nu = (tau - 0.5) / 3.0, fraction = 0.2, drag = test::kDiscDrag.at(0.2);
  const double area = 1.0 * cells * cells, radius = std::sqrt(fraction * area / std::numbers::pi);
  const double u = 0.1 * nu / (2.0 * radius), g = drag * nu * u / area, weight = g * area;
  Fluid fluid =
      test::slow_fluid(SolidTerm::LayeredResistance, {cells, cells, Side::Periodic, Side::Periodic},
                       tau, {0.0, g, 0.0});
  Scene scene;
  scene.fluid = {.density = 1.0,
                 .viscosity = nu,
                 .gravity = {0.0, -weight / ((ratio - 1.0) * fraction * area), 0.0}};
  scene.coupling.emplace();
  scene.particles.emplace();
  const double settling = area / (drag * nu);  // steps, of the mean flux
  const auto start = static_cast<int>(500.0 + 20.0 * (1.0 + ratio) * settling);
  const auto steps = static_cast<int>(std::ceil(4.0 / u));  // the passage of four cells
  int step = 0;
  double relative = 0.0;
  const auto see = [&] {
    if (step++ < start) return;
    for (int y = 0; y < cells; ++y)
      for (int x = 0; x < cells; ++x)
        relative += fluid.cell(x, y).rho * fluid.cell(x, y).u.y() / area / steps;
    relative -= 0.5 * g / steps;
  };
  const FreeRun run = test::free_run(fluid, scene,
                                     {.ratio = ratio,
                                      .radius = radius,
                                      .start = {cells / 2 + 0.23, cells / 2 + 0.0, 0.0},
                                      .steps = start + steps,
                                      .seen = see});
  for (int k = start; k < start + steps; ++k) relative -= run.velocity[k].y() / steps;
  return weight / (nu * relative) / drag - 1.0;
}

TEST(FreeDisc, HasTheDragOfTheArray) {
  // -0.6 % at six cells a diameter and -0.2 % at ten, at any density
  // (lbm_solver/docs/resistance.md).
  for (const double ratio : {1.25, 2.65}) {
    EXPECT_NEAR(free_drag_error(12, ratio), 0.0, 0.008) << ratio;
    EXPECT_NEAR(free_drag_error(20, ratio), 0.0, 0.004) << ratio;
  }
}

TEST(PeriodicCrossing, OfFacesAndCornersChangesNoTrajectory) {
  const Domain domain{48, 40, Side::Periodic, Side::Periodic};
  const Vec3 inside(20.0 + 77.0 / 1024, 19.0 + 301.0 / 1024), gravity(2e-5, -1e-5);
  const auto from = [&](const Vec3& start) {
    return free_run(domain, SolidTerm::LayeredResistance, CollisionOperator::Trt, 0.7, 2.5, 5.25,
                    start, gravity, 1000);
  };
  const FreeRun reference = from(inside);
  EXPECT_GT((reference.place.back() - inside).norm(), 2.0);  // it goes somewhere
  for (const Vec3& shift : {Vec3(24.0, 0.0), Vec3(0.0, 20.0), Vec3(25.0, 18.0)}) {
    const FreeRun shifted = from(inside + shift);
    EXPECT_LT((shifted.velocity.back() - reference.velocity.back()).norm(), 1e-10);
    EXPECT_LT((shifted.place.back() - shift - reference.place.back()).norm(), 1e-10);
  }
}

TEST(FastSettling, HasLittleForceNoiseAtReynolds300) {
  // D/h = 12, τ = 0.5048; what a running mean of 50 steps takes from the force, over the weight: 5
  // %
  const Domain domain{96, 500, Side::Wall, Side::Wall};
  const double gravity = 4.4e-4, radius = 6.0, ratio = 1.25;
  const FreeRun run =
      free_run(domain, SolidTerm::LayeredNobleTorczynski, CollisionOperator::CentralMoment, 0.5048,
               ratio, radius, {47.7, 460.3}, {0.0, -gravity}, 8000);
  const double speed = -run.velocity[7999].y(), viscosity = 0.0048 / 3.0;
  EXPECT_NEAR(speed * 2.0 * radius / viscosity, 310.0, 60.0);
  double square = 0.0;
  int count = 0;
  for (std::size_t k = 4000; k < 7950; ++k, ++count) {
    double mean = 0.0;
    for (std::size_t j = k - 25; j < k + 25; ++j) mean += run.force_y[j] / 50.0;
    square += (run.force_y[k] - mean) * (run.force_y[k] - mean);
  }
  const double weight = ratio * std::numbers::pi * radius * radius * gravity;
  EXPECT_LT(std::sqrt(square / count) / weight, 0.05);
}

/// (μ_r - 1)/φ of one disc, free to turn, in the middle of a box of n × n cells between moving
/// walls: the shear stress at a wall over that of the fluid alone. Re = γR²/ν = 0.02.
double viscosity_gain(const Case& c, double tau, double diameter, double fraction) {
  const double radius = 0.5 * diameter, nu = (tau - 0.5) / 3.0,
               shear = 0.02 * nu / (radius * radius);
  const double area = std::numbers::pi * radius * radius;
  const int n = static_cast<int>(std::lround(std::sqrt(area / fraction)));
  const Domain domain{n, n, Side::Periodic, Side::Wall};
  const Vec3 wall(0.5 * shear * n, 0.0);
  Fluid fluid = make(c, domain, CollisionOperator::Trt, tau);
  for (const auto& [side, u] : {std::pair{SideName::Top, wall}, {SideName::Bottom, Vec3(-wall)}})
    test::add_velocity(fluid, Opening::whole(domain, side), u);
  for (int y = 0; y < n; ++y)
    for (int x = 0; x < n; ++x)
      fluid.set_equilibrium(x, y, 1.0, {shear * (y + 0.5 - 0.5 * n), 0.0});
  Body disc{1, {0.5 * n + 0.23, 0.5 * n}, radius, Vec3(), -0.5 * shear};
  for (int s = 0; s < 0.5 * n * n / nu; ++s) {  // 20 times the slowest decay, (2π/n)² ν, of a shear
    fluid.place(std::vector{disc});
    fluid.step();
    disc.spin.z() += 0.025 * fluid.loads()[0].torque.z() / area;  // until none is left
  }
  double u = 0.0;
  for (int x = 0; x < n; ++x) u += fluid.cell(x, n - 4).u.x() / n;
  return ((wall.x() - u) / 3.5 / shear - 1.0) / (area / (n * n));
}

TEST(DiluteSuspension, HasTheViscosityOfFreeDiscs) {
  // 1 + 2φ [Brady 1984] as φ → 0; the gain is linear in φ where walls and images are far.
  // 10 %: the target at ten cells.
  const Case c{SolidTerm::LayeredResistance};
  for (const double tau : {0.6, 1.0, 1.5}) {
    const double one = viscosity_gain(c, tau, 10.0, 0.01);
    const double two = viscosity_gain(c, tau, 10.0, 0.02);
    const double four = viscosity_gain(c, tau, 10.0, 0.04);
    const double slope = (-4.0 * one - two + 5.0 * four) / 14.0;  // least squares over 1, 2, 4
    const double limit = (one + two + four) / 3.0 - slope * 7.0 / 3.0;
    EXPECT_NEAR(limit / 2.0, 1.0, 0.1) << tau;
  }
}

// (Over 50 steps this disc blows up: its velocity then changes by more than it has in an interval.)
TEST(Averaging, OverSeveralFluidStepsKeepsTheTerminalVelocity) {
  const Domain domain{64, 300, Side::Wall, Side::Wall};
  const auto speed = [&](int fluid_steps) {
    return free_run(domain, SolidTerm::LayeredResistance, CollisionOperator::Trt, 0.7, 1.5, 5.0,
                    {32.0, 260.0}, {0.0, -4e-5}, 6000, fluid_steps)
        .velocity.back()
        .y();
  };
  const double one = speed(1);
  for (const int fluid_steps : {2, 5, 10}) EXPECT_NEAR(speed(fluid_steps) / one, 1.0, 0.01);
}

/// Bodies on a lattice of places in a periodic box, each free to move and turn, coupled as the
/// programs are; they start with random velocities and are left alone. What is left of their
/// kinetic energy, over that at the start; not a number where it blows up.
double energy_left(int dimension, int a_side, double radius, int box, double tau, double ratio,
                   int steps) {
  const bool flat = dimension == 2;
  const Domain domain{box, box, Side::Periodic, Side::Periodic, flat ? 1 : box, Side::Periodic};
  Scene scene;
  scene.box.dimension = dimension;
  scene.fluid = {.density = 1.0, .viscosity = (tau - 0.5) / 3.0};
  scene.coupling.emplace();
  scene.particles.emplace().density = {ratio, ratio};
  Fluid fluid = test::slow_fluid(SolidTerm::LayeredResistance, domain, tau, Vec3());
  Particles particles({1.0, 1.0, 1.0, 1.0, {0.0, 0.0}}, scene, domain,
                      SolidTerm::LayeredResistance);
  const double pi = std::numbers::pi;
  const double mass = ratio * pi * radius * radius * (flat ? 1.0 : 4.0 / 3.0 * radius);
  const double inertia = (flat ? 0.5 : 0.4) * mass * radius * radius;
  std::vector<protocol::Particle> all;
  unsigned state = 1;
  const auto noise = [&state] {  // the same on every machine
    state = state * 1664525U + 1013904223U;
    return 2e-4 * (state / 4294967296.0 - 0.5);
  };
  const double spacing = static_cast<double>(box) / a_side;
  for (int k = 0; k < (flat ? 1 : a_side); ++k)
    for (int j = 0; j < a_side; ++j)
      for (int i = 0; i < a_side; ++i) {
        protocol::Particle p;
        p.state.id = p.shape.id = static_cast<std::int64_t>(all.size()) + 1;
        p.state.x = {(i + 0.53) * spacing, (j + 0.41) * spacing, flat ? 0.0 : (k + 0.47) * spacing};
        p.state.v = {noise(), noise(), flat ? 0.0 : noise()};
        p.state.omega = {0.0, 0.0, noise() / radius};
        p.shape = {p.state.id, radius, mass, inertia, 1};
        all.push_back(p);
      }
  const auto energy = [&] {
    double sum = 0.0;
    for (const auto& p : all)
      for (int k = 0; k < 3; ++k)
        sum += 0.5 * mass * p.state.v[k] * p.state.v[k] +
               0.5 * inertia * p.state.omega[k] * p.state.omega[k];
    return sum;
  };
  const double start = energy();
  for (int step = 0; step < steps; ++step) {
    particles.arrive(all, 1.0);
    fluid.place(particles.bodies(0.0));
    fluid.step();
    particles.add(fluid.loads());
    const auto loads = particles.mean_loads(1);
    for (std::size_t i = 0; i < all.size(); ++i)
      for (int k = 0; k < 3; ++k) {
        protocol::State& s = all[i].state;
        if (!flat || k < 2) s.v[k] += loads[i].force[k] / mass;
        if (!flat || k == 2) s.omega[k] += loads[i].torque[k] / inertia;
        s.x[k] += s.v[k];
      }
  }
  return energy() / start;
}

TEST(FreeSuspension, ComesToRestHoweverDense) {
  // Fluid and bodies share the momentum that the bodies began with, so a part of it remains.
  // 0.39 of the area, and 0.44 of the volume, half a cell apart: those of a cubic array touch at
  // 0.52.
  for (const double ratio : {1.0, 2.17})
    for (const double tau : {0.505, 1.5}) {
      const double discs = energy_left(2, 3, 4.0, 34, tau, ratio, 1000);
      EXPECT_LT(discs, 0.5) << "discs τ " << tau << " ρ " << ratio;
      const double spheres = energy_left(3, 2, 4.0, 17, tau, ratio, 1000);
      EXPECT_LT(spheres, 0.5) << "spheres τ " << tau << " ρ " << ratio;
    }
}

}  // namespace
