// SPDX-License-Identifier: GPL-2.0-or-later
/// The body force that is found for a flow, against flows whose resistance is known.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "lbm_solver/immersed/resistance.h"
#include "lbm_solver/solver/fluid.h"
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
  KernelChoice choice{.force = true, .solid_term = "resistance", .parameters = {.tau = tau}};
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

}  // namespace
