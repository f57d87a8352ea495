// SPDX-License-Identifier: GPL-2.0-or-later
#include "lbm_solver/immersed/cover_map.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "lbm_solver/immersed/weight.h"
#include "lbm_solver/solver/fluid.h"

namespace {

using namespace lbm;

const Domain kDomain{48, 40, Side::Wall, Side::Periodic};

/// Three discs that overlap pairwise, so that cells hold two and three of them.
std::vector<Body> cluster() {
  return {{1, {20.3, 20.1}, 5.0, {0.01, 0.0}, 0.001},
          {2, {27.9, 20.6}, 4.0, {-0.02, 0.01}, 0.0},
          {3, {24.4, 26.0}, 3.7, {0.0, -0.02}, -0.002}};
}

/// A fluid that moves, with the discs in it, after some steps.
Fluid stirred(std::vector<Body> discs) {
  Fluid fluid(kDomain, {"trt", "none", false, "layered_holdych", {.tau = 0.8}});
  for (int y = 0; y < kDomain.ny; ++y)
    for (int x = 0; x < kDomain.nx; ++x)
      fluid.set_equilibrium(x, y, 1.0, {0.02 * std::sin(0.3 * y), 0.03 * std::cos(0.2 * x)});
  for (int step = 0; step < 5; ++step) {
    fluid.place(discs);
    fluid.step();
  }
  return fluid;
}

TEST(ImmersedWeight, HasItsLimits) {
  const ImmersedWeight viscous{WeightRule::Viscous, 0.8}, fraction{WeightRule::Fraction};
  EXPECT_EQ(viscous(0.0), 0.0);
  EXPECT_EQ(viscous(1.0), 1.0);
  EXPECT_EQ(viscous(1.7), 1.0);  // the sum of two solids may exceed one
  EXPECT_EQ(fraction(1.7), 1.0);
  EXPECT_NEAR(viscous(0.5), 0.5 * 0.3 / 0.8, 1e-15);
  EXPECT_EQ(fraction(0.3), 0.3);
}

TEST(CoverMap, LoadsOfSharedCellsAddUpToTheWholeForce) {
  const Fluid fluid = stirred(cluster());
  Vec3 whole(0.0, 0.0), shared(0.0, 0.0);
  for (int y = 0; y < kDomain.ny; ++y)
    for (int b = 0; b < fluid.cover()->blocks_per_row(); ++b)
      if (const auto* block = fluid.cover()->block<2>(y, 0, b))
        for (int lane = 0; lane < kPackWidth; ++lane)
          whole += Vec3(block->force[0][lane], block->force[1][lane]);
  for (const BodyLoad& load : fluid.loads()) shared += load.force;
  EXPECT_NEAR((whole - shared).norm(), 0.0, 1e-14);
  EXPECT_GT(whole.norm(), 1e-3);
}

TEST(CoverMap, LoadsDoNotDependOnTheOrderOfTheDiscs) {
  auto discs = cluster();
  const auto reference = stirred(discs).loads();
  std::sort(discs.begin(), discs.end(), [](const Body& a, const Body& b) { return a.id > b.id; });
  const auto reversed = stirred(discs).loads();
  for (int i = 0; i < 3; ++i) {
    // sums of two or three fractions in another order: round-off only
    EXPECT_NEAR((reference[i].force - reversed[2 - i].force).norm(), 0.0, 1e-14);
    EXPECT_NEAR(reference[i].torque.z(), reversed[2 - i].torque.z(), 1e-13);
  }
}

TEST(CoverMap, DiscsComeAndGo) {
  CoverMap cover(kDomain, {WeightRule::Viscous, 0.8});
  cover.update({});
  EXPECT_EQ(cover.covered_blocks(), 0U);
  const auto discs = cluster();
  cover.update(discs);
  EXPECT_EQ(cover.solid_fraction(20, 20), 1.0);
  cover.update(std::vector<Body>{discs[2]});
  EXPECT_EQ(cover.solid_fraction(18, 18), 0.0);
  EXPECT_EQ(cover.solid_fraction(24, 26), 1.0);
  cover.update({});
  EXPECT_EQ(cover.solid_fraction(24, 26), 0.0);
  EXPECT_TRUE(cover.loads().empty());
}

TEST(CoverMap, NextCoveredSkipsPureFluid) {
  CoverMap cover(kDomain, {WeightRule::Viscous, 0.8});
  cover.update(std::vector<Body>{{1, {40.5, 20.0}, 2.0, {0, 0}}});
  EXPECT_EQ(cover.next_covered(20, 0, 0), 38 / kPackWidth);
  EXPECT_EQ(cover.next_covered(3, 0, 0), cover.blocks_per_row());
}

}  // namespace
