// SPDX-License-Identifier: GPL-2.0-or-later
/// Boundaries, forcing and turbulence against what they must give; stability of the operators.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "tests/support/openings.h"

namespace {

using namespace lbm;
using std::numbers::pi;

void run(Fluid& fluid, int steps) {
  for (int s = 0; s < steps; ++s) fluid.step();
}

void add_lid(Fluid& fluid, double u, const InTime& in_time = {}) {
  test::add_velocity(fluid, Opening::whole(fluid.domain(), SideName::Top), {u, 0.0}, false,
                     in_time);
}

TEST(Couette, IsLinearToRoundOffWithEveryOperator) {
  for (const CollisionOperator collision : choices<CollisionOperator>()) {
    const int nx = 5, ny = 16;
    Fluid fluid({nx, ny, Side::Periodic, Side::Wall},
                {.collision = collision, .parameters = {.tau = 1.0}});
    add_lid(fluid, 0.01);
    run(fluid, 20000);
    for (int y = 0; y < ny; ++y)
      EXPECT_NEAR(fluid.cell(2, y).u.x(), 0.01 * (y + 0.5) / ny, 1e-12) << collision << ' ' << y;
  }
}

TEST(Poiseuille, IsExactWithTrtAndTheMagicRate) {
  const int nx = 5, ny = 16;
  for (const double tau : {0.55, 0.8, 1.5}) {
    const double nu = (tau - 0.5) / 3.0, u = 0.01, g = 8.0 * nu * u / (ny * ny);
    Fluid fluid({nx, ny, Side::Periodic, Side::Wall},
                {.force = true, .parameters = {.tau = tau, .force_x = g}});
    run(fluid, static_cast<int>(4.0 * ny * ny / nu));
    for (int y = 0; y < ny; ++y) {
      const double s = y + 0.5;
      EXPECT_NEAR(fluid.cell(2, y).u.x(), g * s * (ny - s) / (2.0 * nu), 1e-10 * u) << tau;
    }
  }
}

/// Every operator and the body force: the momentum of a periodic box grows by F a step.
TEST(BodyForce, GivesItsMomentumToEveryOperator) {
  for (const CollisionOperator collision : choices<CollisionOperator>())
    for (const double smagorinsky : {0.0, 0.1}) {
      Fluid fluid({9, 7, Side::Periodic, Side::Periodic},
                  {.collision = collision,
                   .force = true,
                   .parameters = {
                       .tau = 0.6, .smagorinsky = smagorinsky, .force_x = 1e-5, .force_y = -2e-5}});
      run(fluid, 100);
      // rho u = Σ c f + F/2 after 100 steps from Σ c f = 0; round-off of 100 whole populations
      EXPECT_NEAR(fluid.cell(4, 3).u.x(), 100.5e-5, 1e-14) << collision;
      EXPECT_NEAR(fluid.cell(4, 3).u.y(), -201.0e-5, 1e-14) << collision;
    }
}

/// A force that comes up in 40 steps: after n steps the momentum is F Σ factor(s), and what is
/// shown has half of the coming step's force in it. One step at a time, all at once, and on from a
/// state.
TEST(BodyForce, ComesUpInItsRamp) {
  const InTime ramp{40.0, 0.0};
  const double force = 1e-5;
  for (const CollisionOperator collision : choices<CollisionOperator>()) {
    const auto fluid = [&] {
      Fluid f(
          {9, 7, Side::Periodic, Side::Periodic},
          {.collision = collision, .force = true, .parameters = {.tau = 0.6, .force_x = force}});
      f.vary_body_force(ramp);
      return f;
    };
    Fluid single = fluid(), whole = fluid(), restored = fluid();
    double sum = 0.0;
    for (int n = 1; n <= 60; ++n) {
      sum += force * ramp.factor(n);
      single.step();
      EXPECT_NEAR(single.cell(4, 3).u.x(), sum + 0.5 * force * ramp.factor(n + 1), 1e-14)
          << collision << ' ' << n;
      if (n == 23) restored.load(single.save());
    }
    whole.advance(60);
    restored.advance(37);
    EXPECT_EQ(whole.cell(4, 3).u.x(), single.cell(4, 3).u.x()) << collision;
    EXPECT_EQ(restored.cell(4, 3).u.x(), single.cell(4, 3).u.x()) << collision;
  }
}

/// Largest error of Stokes' second problem, u = U e^{-ky} cos(wt - ky), in its first two wave
/// lengths.
double stokes_error(int cells_per_depth) {
  const double tau = 0.8, nu = (tau - 0.5) / 3.0, k = 1.0 / cells_per_depth, w = 2.0 * nu * k * k;
  const int nx = 3, ny = 12 * cells_per_depth;
  const double period = 2.0 * pi / w, u = 0.01;
  Fluid fluid({nx, ny, Side::Periodic, Side::Wall}, {.parameters = {.tau = tau}});
  add_lid(fluid, u, InTime{0.0, period});
  const int steps = static_cast<int>(8.0 * period);
  run(fluid, steps);
  double error = 0.0;
  for (int y = ny - 1; y > ny - 4 * cells_per_depth; --y) {
    const double depth = k * (ny - y - 0.5);
    const double exact = u * std::exp(-depth) * std::cos(w * steps - depth);
    error = std::max(error, std::abs(fluid.cell(1, y).u.x() - exact) / u);
  }
  return error;
}

TEST(StokesSecondProblem, ConvergesWithSecondOrder) {
  const double coarse = stokes_error(4), fine = stokes_error(8);
  EXPECT_LT(coarse, 0.02);
  EXPECT_NEAR(std::log2(coarse / fine), 2.0,
              0.35);  // the phase of the last whole step adds a little
}

TEST(Smagorinsky, GivesItsViscosityInPureShear) {
  // Couette: |S| = shear rate, nu_t = (S_c)² |S|, the same everywhere; the wall's force tells it
  const int nx = 5, ny = 16;
  const double tau = 0.502, s_c = 0.3, u = 0.02, rate = u / ny;
  const auto check = [&](CollisionOperator collision, VelocitySet lattice) {
    // Λ = 3/16 would make TRT's odd rate 1/94 here: its odd modes then carry tau^- u ∇u into Q_xx,
    // which the model takes for strain (0.9 % in the stress at this speed, 5 % at u = 0.1).
    KernelChoice les{.collision = collision,
                     .parameters = {.tau = tau, .magic = 1e-3, .smagorinsky = s_c}};
    les.lattice = lattice;
    const int nz = lattice == VelocitySet::D2Q9 ? 1 : 3;
    Fluid fluid({nx, ny, Side::Periodic, Side::Wall, nz, Side::Periodic}, les);
    for (int z = 0; z < nz; ++z)
      for (int y = 0; y < ny; ++y)
        for (int x = 0; x < nx; ++x)
          fluid.set_equilibrium(Cell3{x, y, z}, 1.0, {rate * (y + 0.5), 0.0});
    add_lid(fluid, u);
    fluid.advance(40000);
    // shear stress in the middle: rho (nu + nu_t) rate = -(1 - 1/(2 tau*)) Σ c_x c_y f^neq
    double stress = 0.0;
    const auto c = fluid.cell(2, ny / 2, nz / 2);
    const Lattice& l = fluid.lattice();
    for (int q = 1; q < l.Q; ++q)
      stress += l.c[q][0] * l.c[q][1] * fluid.arriving(q, 2, ny / 2, nz / 2);
    stress -= c.rho * c.u.x() * c.u.y();
    const double nu = (tau - 0.5) / 3.0 + s_c * s_c * rate, total = 3.0 * nu + 0.5;
    EXPECT_NEAR(-(1.0 - 0.5 / total) * stress / (nu * rate), 1.0, 1e-3) << collision << lattice;
  };
  for (const CollisionOperator collision : choices<CollisionOperator>())
    for (const VelocitySet lattice : {VelocitySet::D2Q9, VelocitySet::D3Q19, VelocitySet::D3Q27})
      check(collision, lattice);
}

/// Part of a sound pulse that comes back from the right side.
double reflection(bool absorbing) {
  const int nx = 400, ny = 4, width = 12;
  Fluid fluid({nx, ny, Side::Wall, Side::Periodic}, {.parameters = {.tau = 0.55}});
  const Opening right = Opening::whole(fluid.domain(), SideName::Right);
  if (absorbing)
    test::add_outflow(fluid, right, 0.0, 0.58 / nx);
  else
    test::add_pressure(fluid, right, 0.0);
  for (int x = 0; x < nx; ++x)
    for (int y = 0; y < ny; ++y) {
      const double p = 1e-4 * std::exp(-std::pow((x - 250.0) / width, 2));
      fluid.set_equilibrium(x, y, 1.0 + p, {p / std::sqrt(3.0), 0.0});  // runs to the right
    }
  run(fluid, static_cast<int>(220 * std::sqrt(3.0)));  // there and some way back
  double largest = 0.0;
  for (int x = 0; x < nx; ++x) largest = std::max(largest, std::abs(fluid.cell(x, 2).rho - 1.0));
  return largest / 1e-4;
}

TEST(Outflow, ReflectsLittle) {
  EXPECT_GT(reflection(false), 0.5);  // a given pressure sends the pulse back
  EXPECT_LT(reflection(true), 0.05);
}

/// Sucked at from the other end, an open side lets fluid in from rest: nowhere faster than
/// Bernoulli's √(2 Δp/rho), up to the profile (some per cent here). Carried outward alone, the flow
/// would feed on itself: 4 times that speed.
TEST(Outflow, LetsFluidInNoFasterThanBernoulli) {
  for (const double drho : {0.001, 0.01}) {
    Fluid fluid({60, 30, Side::Wall, Side::Wall},
                {.collision = CollisionOperator::CentralMoment, .parameters = {.tau = 0.51}});
    test::add_pressure(fluid, Opening::whole(fluid.domain(), SideName::Left), -drho, {500.0, 0.0});
    test::add_outflow(fluid, Opening::whole(fluid.domain(), SideName::Right), 0.0, 0.01);
    double largest = 0.0;
    for (int look = 0; look < 80; ++look) {
      fluid.advance(100);
      largest = std::max(largest, fluid.extremes().max_speed);
    }
    const double bernoulli = std::sqrt(2.0 * drho / 3.0);
    EXPECT_LT(largest, 1.1 * bernoulli) << drho;
    EXPECT_GT(largest, 0.5 * bernoulli) << drho;  // it does flow
  }
}

/// Discs at different speeds leave a closed box through an open side, three at a time: the fluid
/// that takes their place comes in there, and moves about as fast as they do.
TEST(Outflow, GrainsPassThrough) {
  Fluid fluid({60, 60, Side::Wall, Side::Wall}, {.collision = CollisionOperator::CentralMoment,
                                                 .solid_term = SolidTerm::LayeredNobleTorczynski,
                                                 .parameters = {.tau = 0.51}});
  test::add_outflow(fluid, Opening::whole(fluid.domain(), SideName::Right), 0.0, 0.01);
  double largest = 0.0;
  for (int step = 0; step < 6000; ++step) {
    std::vector<Body> discs;
    for (int i = 0; i < 18; ++i) {
      const double speed = 0.005 + 0.001 * (i * 7 % 18);
      const double x = std::fmod(20.0 * (i % 3) + 3.0 * i + speed * step, 75.0);
      if (x < 60.0) discs.push_back({i, {x, 5.0 + 10.0 * (i / 3)}, 4.0, {speed, 0.0}});
    }
    fluid.place(discs);
    fluid.step();
    if (step % 50 == 0) largest = std::max(largest, fluid.extremes().max_speed);
  }
  EXPECT_LT(largest, 8.0 * 0.022);  // gaps between them are a fifth of the section
}

TEST(ImpulsivePressure, WithARampOvershootsLittle) {
  const int nx = 120, ny = 5;
  const double drho = 0.01, sound = nx * std::sqrt(3.0);
  Fluid fluid({nx, ny, Side::Wall, Side::Periodic}, {.parameters = {.tau = 0.6}});
  test::add_pressure(fluid, Opening::whole(fluid.domain(), SideName::Left), drho,
                     {6.0 * sound, 0.0});
  double largest = 0.0;
  for (int step = 0; step < 20 * sound; ++step) {
    fluid.step();
    largest = std::max(largest, fluid.cell(nx - 1, 2).rho - 1.0);
  }
  EXPECT_LT(largest, 1.1 * drho);
  EXPECT_GT(largest, 0.95 * drho);
}

/// Double shear layer [MinionBrown1997], N = 128, kappa = 80, to t = 1.5: did it stay bounded?
bool shear_layer_bounded(CollisionOperator collision, double reynolds, double u) {
  const int n = 128;
  const double nu = u * n / reynolds;
  Fluid fluid({n, n, Side::Periodic, Side::Periodic},
              {.collision = collision, .parameters = {.tau = 0.5 + 3.0 * nu}});
  for (int y = 0; y < n; ++y)
    for (int x = 0; x < n; ++x) {
      const double a = (x + 0.5) / n, b = (y + 0.5) / n;
      fluid.set_equilibrium(x, y, 1.0,
                            {u * std::tanh(80.0 * (b <= 0.5 ? b - 0.25 : 0.75 - b)),
                             0.05 * u * std::sin(2.0 * pi * (a + 0.25))});
    }
  run(fluid, static_cast<int>(1.5 * n / u));
  const auto e = fluid.extremes();
  return e.finite && e.max_speed < 2.5 * u;
}

TEST(ShearLayer, CentralMomentsAndRecursiveRegularisedStayBoundedInAllSixCases) {
  for (const double reynolds : {1e4, 1e5})
    for (const double u : {0.05, 0.1, 0.2})
      for (const auto collision :
           {CollisionOperator::CentralMoment, CollisionOperator::RecursiveRegularised})
        EXPECT_TRUE(shear_layer_bounded(collision, reynolds, u))
            << collision << ' ' << reynolds << ' ' << u;
}

}  // namespace
