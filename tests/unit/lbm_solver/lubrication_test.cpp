// SPDX-License-Identifier: GPL-2.0-or-later
#include "lbm_solver/coupling/lubrication.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

namespace {

using namespace lbm;

const Domain kDomain{60, 40, Side::Periodic, Side::Wall};
constexpr double kFixed = std::numeric_limits<double>::infinity();

/// Cylinder that moves towards a plane, exact: 4π μ U / (α - tanh α), cosh α = 1 + h/R [Jeffrey
/// and Onishi 1981].
double exact_resistance(double gap, double radius, double viscosity) {
  const double alpha = std::acosh(1.0 + gap / radius);
  return 4.0 * std::numbers::pi * viscosity / (alpha - std::tanh(alpha));
}

std::vector<BodyLoad> loads(const Lubrication& l, const std::vector<Body>& discs,
                            const std::vector<double>& masses) {
  std::vector<BodyLoad> result(discs.size());
  l.add(discs, masses, kDomain, result);
  return result;
}

TEST(Lubrication, TendsToTheExactResistanceInNarrowGaps) {
  const Lubrication l{0.1, 1.0, 1.0};
  const double radius = 10.0;
  for (const double gap : {0.02, 0.05, 0.1}) {
    const double exact = exact_resistance(gap, radius, 0.1) - exact_resistance(1.0, radius, 0.1);
    EXPECT_NEAR(l.resistance(gap, radius) / exact, 1.0, 0.05) << gap;
  }
  EXPECT_EQ(l.resistance(1.0, radius), 0.0);
  EXPECT_EQ(l.resistance(2.0, radius), 0.0);
}

TEST(Lubrication, ActsEquallyOnBothAndAgainstTheMotion) {
  const Lubrication l{0.1, 1.0, 1.0};
  const std::vector<Body> discs{{1, {20.0, 20.0}, 5.0, {0.01, 0.0}, 0.0},
                                {2, {30.3, 20.0}, 5.0, {-0.02, 0.0}, 0.0},
                                {3, {45.0, 20.0}, 4.0, {0.5, 0.0}, 0.0}};
  const auto result = loads(l, discs, {100.0, 200.0, 100.0});
  EXPECT_LT(result[0].force.x(), 0.0);
  EXPECT_EQ(result[0].force.x(), -result[1].force.x());
  EXPECT_EQ(result[2].force.norm(), 0.0);  // too far from both
}

TEST(Lubrication, CrossesAPeriodicSideOnce) {
  const Lubrication l{0.1, 1.0, 1.0};
  const std::vector<double> masses{100.0, 100.0};
  const auto inside = loads(
      l, {{1, {25.0, 20.0}, 5.0, {0.01, 0.0}, 0.0}, {2, {35.25, 20.0}, 5.0, {-0.02, 0.0}, 0.0}},
      masses);
  const auto across = loads(
      l, {{1, {55.0, 20.0}, 5.0, {0.01, 0.0}, 0.0}, {2, {5.25, 20.0}, 5.0, {-0.02, 0.0}, 0.0}},
      masses);
  EXPECT_NEAR(across[0].force.x(), inside[0].force.x(), 1e-13);
  EXPECT_NEAR(across[1].force.x(), inside[1].force.x(), 1e-13);
}

TEST(Lubrication, NeverThrowsAPairBack) {
  const Lubrication l{0.5, 1.0, 1.0};
  const double mass = 80.0;
  for (const double gap : {1e-9, 1e-3, 0.1, 0.5}) {
    const auto result = loads(l, {{1, {30.0, 5.0 + gap}, 5.0, {0.0, -0.02}, 0.0}}, {mass});
    const double velocity_after = -0.02 + result[0].force.y() / mass;
    EXPECT_GT(result[0].force.y(), 0.0);
    EXPECT_LE(velocity_after, 0.0) << gap;
  }
}

TEST(Lubrication, FixedBodiesDoNotPushEachOther) {
  const Lubrication l{0.1, 1.0, 1.0};
  const auto result =
      loads(l, {{1, {25.0, 20.0}, 5.0, {0.0, 0.0}, 0.0}, {2, {35.25, 20.0}, 5.0, {0.0, 0.0}, 0.0}},
            {kFixed, kFixed});
  EXPECT_EQ(result[0].force.norm(), 0.0);
}

}  // namespace
