// SPDX-License-Identifier: GPL-2.0-or-later
/// The body force that is found for a flow, against flows whose resistance is known.
#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <numbers>

#include "lbm_solver/immersed/resistance.h"
#include "lbm_solver/solver/fluid.h"
#include "lbm_solver/solver/held_lag.h"
#include "lbm_solver/viscosity/relaxation_table.h"
#include "lbm_solver/viscosity/viscosity_law.h"
#include "tests/support/array_references.h"

namespace {

using namespace lbm;

constexpr int kHeight = 32;

/// A channel along x in which a mean velocity is held.
Fluid channel(const CollisionParameters& parameters, double speed, const InTime& in_time = {}) {
  Fluid fluid({16, kHeight, Side::Periodic, Side::Wall}, {.force = true, .parameters = parameters});
  fluid.hold_flow({0, speed, in_time, 16});
  return fluid;
}

// Between planes U = G H²/(12 ν). The flux of half-way walls is too large by H G/(24 ν) at Λ =
// 3/16, as a part 1/(2 H) of it times 1/H: 1/2048 here.
TEST(FlowControl, FindsTheForceOfAChannel) {
  constexpr double tau = 0.8, nu = (tau - 0.5) / 3.0, speed = 0.01;
  Fluid fluid = channel({.tau = tau}, speed);
  fluid.advance(40000);
  EXPECT_NEAR(mean_velocity(fluid, 0) / speed, 1.0, 1e-6);
  EXPECT_NEAR(fluid.body_force().x() / (12.0 * nu * speed / (kHeight * kHeight)), 1.0, 0.001);
}

// The mean velocity follows dU/dt = (U₀ - U)/T with T of 50 steps: e⁻¹⁰ is left after 500.
TEST(FlowControl, ConvergesAsFastAsItSays) {
  constexpr double speed = 0.01;
  Fluid fluid = channel({.tau = 0.8}, speed);
  for (const int steps : {50, 100, 200}) {
    fluid.advance(steps - fluid.steps());
    EXPECT_NEAR(1.0 - mean_velocity(fluid, 0) / speed, std::exp(-steps / 50.0), 0.1) << steps;
  }
  fluid.advance(300);
  EXPECT_NEAR(mean_velocity(fluid, 0) / speed, 1.0, 0.01);
}

// Power law, n = 0.5: σ_w = K (2 (2n+1)/n U/H)ⁿ = G H/2. At 32 cells the flow is 0.1 % off
// (docs/viscosity.md), and the force half of that.
TEST(FlowControl, FindsTheForceOfAGel) {
  constexpr double tau = 1.0, nu = (tau - 0.5) / 3.0, index = 0.5;
  constexpr double rate = 2.56 / (kHeight * kHeight), speed = rate * kHeight / 8.0;
  FluidScene gel{.density = 1.0};
  gel.law = {.model = ViscosityScene::Model::PowerLaw,
             .consistency = nu * std::pow(rate, 1.0 - index),
             .index = index};
  const ViscosityLaw law(gel, rate);
  CollisionParameters parameters{.tau = tau};
  parameters.viscosity_table =
      std::make_shared<RelaxationTable>([law](double r) { return 0.5 + 3.0 * law(r); });
  Fluid fluid = channel(parameters, speed);
  fluid.advance(20000);
  EXPECT_NEAR(mean_velocity(fluid, 0) / speed, 1.0, 1e-5);
  EXPECT_NEAR(fluid.body_force().x() / (2.0 * nu * rate / kHeight), 1.0, 0.002);
}

// A disc in each period of a square array: the force on a period is μ U times what is known. The
// error of a drag at ten cells across is 0.1 %.
TEST(FlowControl, FindsTheForceOfAnArray) {
  constexpr int n = 20;
  constexpr double tau = 0.8, nu = (tau - 0.5) / 3.0, speed = 1e-3, fraction = 0.2;
  KernelChoice choice{
      .force = true, .solid_term = SolidTerm::Resistance, .parameters = {.tau = tau}};
  choice.parameters.magic = kResistanceMagic;
  Fluid fluid({n, n, Side::Periodic, Side::Periodic}, choice);
  fluid.place(std::vector<Body>{
      {1, {0.5 * n + 0.23, 0.5 * n + 0.41, 0.0}, n * std::sqrt(fraction / std::numbers::pi)}});
  fluid.hold_flow({0, speed, {}, n});
  fluid.advance(10000);
  EXPECT_NEAR(mean_velocity(fluid, 0) / speed, 1.0, 1e-6);
  EXPECT_NEAR(fluid.body_force().x() * n * n / (nu * speed * test::kDiscDrag.at(fraction)), 1.0,
              0.01);
}

// Momenta are rounded before they are added up, 2⁻⁵² of a velocity in this box: of a flow of 5e-9
// cells a step it finds the force as of a fast one, at every step. (With 2⁻³² it was 84 % off.)
TEST(FlowControl, FindsTheForceOfASlowFlow) {
  constexpr double tau = 0.8, nu = (tau - 0.5) / 3.0, speed = 5e-9;
  Fluid fluid = channel({.tau = tau}, speed);
  fluid.advance(30000);
  for (int look = 0; look < 100; ++look) {
    fluid.advance(7);
    EXPECT_NEAR(fluid.body_force().x() / (12.0 * nu * speed / (kHeight * kHeight)), 1.0, 0.001);
  }
  EXPECT_NEAR(mean_velocity(fluid, 0) / speed, 1.0, 1e-6);
}

// Stopped at any step, also between two looks, it goes on to the bit.
TEST(FlowControl, GoesOnToTheBit) {
  const auto make = [] { return channel({.tau = 0.6}, 0.02, {.ramp_steps = 60.0}); };
  Fluid whole = make();
  whole.advance(43);
  Fluid rest = make();
  rest.load(whole.save());
  whole.advance(150);
  rest.advance(70);
  rest.advance(80);
  EXPECT_EQ(whole.save(), rest.save());
  EXPECT_GT(whole.flow_control()->force(), 0.0);
}

// Single steps and many at once are the same.
TEST(FlowControl, DoesNotDependOnHowStepsAreAsked) {
  Fluid many = channel({.tau = 0.6}, 0.02), single = channel({.tau = 0.6}, 0.02);
  many.advance(97);
  for (int step = 0; step < 97; ++step) single.step();
  EXPECT_EQ(many.save(), single.save());
}

/// A channel along x between two openings, the left one of which holds a flow into the box.
Fluid open_channel(double tau, double speed, int length, const InTime& in_time = {}) {
  Fluid fluid({length, kHeight, Side::Wall, Side::Wall}, {.parameters = {.tau = tau}});
  for (const SideName side : {SideName::Left, SideName::Right}) {
    const Opening whole = Opening::whole(fluid.domain(), side);
    fluid.add(std::make_unique<PressurePatch>(fluid.links(whole), side, 0.0, InTime{}));
  }
  fluid.hold_flow(PressureControl(0, speed * kHeight, in_time, kHeight, length, 0.0));
  return fluid;
}

// p = 12 ν U L/H², to which the openings add what it takes to bend a uniform inflow: 1 % of it is
// some hundredths of a cell's height of channel.
TEST(PressureControl, FindsThePressureOfAChannel) {
  constexpr double tau = 0.9, nu = (tau - 0.5) / 3.0, speed = 0.004;
  constexpr int length = 96;
  Fluid fluid = open_channel(tau, speed, length);
  fluid.advance(40000);
  const PressureControl& control = *fluid.pressure_control();
  EXPECT_NEAR(control.flow() / (speed * kHeight), 1.0, 1e-6);
  const double pressure = 12.0 * nu * speed * length / (kHeight * kHeight);
  EXPECT_NEAR(control.drho() / 3.0 / pressure, 1.0, 0.02);
}

// Twice the impedance of the open channel is its resistance here, a hundred times in a block of
// discs that nearly touch: neither swings, both come to the flow. Without resistance (a short, wide
// channel of a thin fluid) the inertia does not swing either.
TEST(PressureControl, ComesToTheFlowAgainstAnyResistance) {
  constexpr double speed = 1e-3;
  for (const double radius : {0.0, 7.3}) {
    const int length = 64;
    Fluid fluid({length, kHeight, Side::Wall, Side::Wall},
                {.solid_term = SolidTerm::Resistance,
                 .parameters = {.tau = 0.8, .magic = kResistanceMagic}});
    for (const SideName side : {SideName::Left, SideName::Right}) {
      const Opening whole = Opening::whole(fluid.domain(), side);
      fluid.add(std::make_unique<PressurePatch>(fluid.links(whole), side, 0.0, InTime{}));
    }
    std::vector<Body> discs;
    for (int k = 0; k < 4 && radius > 0.0; ++k)
      discs.push_back({k + 1, {24.0 + 16.0 * (k % 2), 8.0 + 16.0 * (k / 2), 0.0}, radius});
    fluid.place(discs);
    fluid.hold_flow(PressureControl(0, speed * kHeight, {}, kHeight, length, 0.0));
    double most = 0.0;
    // through discs that nearly touch the box fills as slowly as its resistance times what it
    // stores under pressure: 8000 steps to the e-th part
    for (int look = 0; look < (radius > 0.0 ? 900 : 400); ++look) {
      fluid.advance(100);
      most = std::max(most, fluid.pressure_control()->flow());
    }
    EXPECT_NEAR(fluid.pressure_control()->flow() / (speed * kHeight), 1.0, 1e-4) << radius;
    EXPECT_LT(most / (speed * kHeight), 1.3) << radius;
    RecordProperty("drho" + std::to_string(radius > 0.0),
                   std::to_string(fluid.pressure_control()->drho()));
  }
}

/// Amplitude of the flow that comes of an oscillation, over that of the one that is to be held.
double held_amplitude(double tau, int length, double period) {
  constexpr double speed = 0.002;
  Fluid fluid = open_channel(tau, speed, length, {.period_steps = period});
  fluid.advance(static_cast<std::int64_t>(4.0 * period));
  std::complex<double> sum = 0.0;
  const auto looks = static_cast<int>(period / PressureControl::kEvery);
  for (int look = 0; look < looks; ++look) {
    fluid.advance(PressureControl::kEvery);
    sum += fluid.pressure_control()->flow() *
           std::polar(2.0 / looks, -2.0 * std::numbers::pi * look / looks);
  }
  return std::abs(sum) / (speed * kHeight);
}

// The balance of the first harmonic (held_lag.h), in a channel that resists a quarter as much as
// the opening is stiff, and in one that hardly does and overshoots: off by up to 0.014.
TEST(PressureControl, FollowsAnOscillationAsFarAsItSays) {
  constexpr int length = 48;
  const double time = PressureControl::time(length);
  for (const double tau : {0.9, 0.53})
    for (const double period : {1.4 * time, 5.0 * time}) {
      const double part = std::abs(held_part({length, kHeight, (tau - 0.5) / 3.0}, period));
      EXPECT_NEAR(held_amplitude(tau, length, period), part, 0.03) << tau << ' ' << period / time;
    }
}

TEST(PressureControl, GoesOnToTheBit) {
  Fluid first = open_channel(0.7, 0.01, 40), second = open_channel(0.7, 0.01, 40);
  first.advance(101);
  second.load(first.save());
  first.advance(57);
  second.advance(57);
  EXPECT_TRUE(first.save() == second.save());
}

}  // namespace
