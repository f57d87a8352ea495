// SPDX-License-Identifier: GPL-2.0-or-later
/// Drives that change in time: a channel under an oscillating body force, and tables.
#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <numbers>

#include "lbm_solver/solver/fluid.h"

namespace {

using namespace lbm;
using std::numbers::pi;
using Complex = std::complex<double>;

constexpr int kHeight = 32;

/// Complex amplitude of a flow under the force G cos(wt), over G/w, of [Womersley1955] between
/// planes: u = Re((1 - cosh(λ y/a)/cosh λ)/i e^{iwt}), λ = α √i, α = a √(w/nu).
struct Amplitudes {
  Complex middle, mean;
};
Amplitudes exact(double alpha) {
  const Complex i(0.0, 1.0), lambda = alpha * std::sqrt(i);
  return {(1.0 - 1.0 / std::cosh(lambda)) / i, (1.0 - std::tanh(lambda) / lambda) / i};
}

Amplitudes computed(double alpha, const InTime* table) {
  constexpr double tau = 0.8, nu = (tau - 0.5) / 3.0, a = 0.5 * kHeight;
  const double w = alpha * alpha * nu / (a * a), period = 2.0 * pi / w, force = 0.01 * w;
  Fluid fluid({8, kHeight, Side::Periodic, Side::Wall},
              {.force = true, .parameters = {.tau = tau, .force_x = force}});
  fluid.vary_body_force(table ? *table : InTime{0.0, period});
  // what is left of the start, e^{-nu (π/2a)² t}, falls below 1e-4 in 9600 steps
  const int before = static_cast<int>(std::ceil(9600.0 / period) * period);
  const int steps = static_cast<int>(std::lround(period * std::ceil(300.0 / period)));
  fluid.advance(before);
  Amplitudes sum{0.0, 0.0};
  for (int n = 0; n < steps; ++n) {
    const Complex turn = std::polar(2.0 / steps, -w * (before + n));
    double flow = 0.0;
    for (int y = 0; y < kHeight; ++y) flow += fluid.cell(3, y).u.x() / kHeight;
    sum.middle +=
        turn * 0.5 * (fluid.cell(3, kHeight / 2).u.x() + fluid.cell(3, kHeight / 2 - 1).u.x());
    sum.mean += turn * flow;
    fluid.step();
  }
  return {sum.middle * (w / force), sum.mean * (w / force)};
}

void expect_near(const Complex& found, const Complex& wanted, const std::string& what) {
  testing::Test::RecordProperty(what, std::to_string(std::abs(found) / std::abs(wanted) - 1.0) +
                                          ", " + std::to_string(std::arg(found / wanted)));
  EXPECT_NEAR(std::abs(found) / std::abs(wanted), 1.0, 0.01) << what << ", amplitude";
  EXPECT_NEAR(std::arg(found / wanted), 0.0, 0.01) << what << ", phase in radians";
}

// 1 % in amplitude and 0.01 radians in phase at 32 cells: second order in cell and step.
TEST(Womersley, AmplitudeAndPhaseOfTheMiddleAndOfTheFlow) {
  for (const double alpha : {1.0, 4.0, 10.0}) {
    const Amplitudes found = computed(alpha, nullptr), wanted = exact(alpha);
    const std::string at = "alpha" + std::to_string(static_cast<int>(alpha));
    expect_near(found.middle, wanted.middle, at + "_middle");
    expect_near(found.mean, wanted.mean, at + "_flow");
  }
}

// The same oscillation from a periodic table of 64 lines: their chords are lower than the cosine by
// (2π/64)²/12 = 0.08 % of it.
TEST(Womersley, FromATable) {
  constexpr double alpha = 4.0, nu = 0.1, a = 0.5 * kHeight;
  const double period = 2.0 * pi / (alpha * alpha * nu / (a * a));
  TimeTable table{.repeats = true};
  for (int line = 0; line <= 64; ++line) {
    table.steps.push_back(line * period / 64.0);
    table.factors.push_back(line == 64 ? 1.0 : std::cos(2.0 * pi * line / 64.0));
  }
  const InTime in_time{.table = std::make_shared<TimeTable>(table)};
  const Amplitudes found = computed(alpha, &in_time), wanted = exact(alpha);
  expect_near(found.middle, wanted.middle, "middle");
  expect_near(found.mean, wanted.mean, "flow");
}

TEST(TimeTable, IsStraightBetweenItsLinesAndHoldsOrRepeats) {
  TimeTable table{{10.0, 20.0, 40.0}, {0.0, 1.0, 0.0}};
  EXPECT_EQ(table.factor(0.0), 0.0);
  EXPECT_EQ(table.factor(15.0), 0.5);
  EXPECT_EQ(table.factor(30.0), 0.5);
  EXPECT_EQ(table.factor(1e9), 0.0);
  table.factors.back() = 2.0;
  EXPECT_EQ(table.factor(40.0), 2.0);
  EXPECT_EQ(table.factor(50.0), 2.0);
  table.factors.back() = 0.0;
  table.repeats = true;
  EXPECT_EQ(table.factor(40.0), 0.0);
  EXPECT_EQ(table.factor(45.0), 0.5);
  EXPECT_EQ(table.factor(3.0e6 + 20.0), 1.0);
  EXPECT_EQ(table.factor(5.0), 0.25);  // before its first line, too
}

}  // namespace
