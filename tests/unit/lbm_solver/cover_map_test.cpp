// SPDX-License-Identifier: GPL-2.0-or-later
#include "lbm_solver/immersed/cover_map.h"

#include <gtest/gtest.h>
#ifdef __GLIBC__
#include <malloc.h>
#endif

#include <algorithm>
#include <cstdio>
#include <deque>

#include "lbm_solver/immersed/geometry.h"
#include "lbm_solver/immersed/moving_shape.h"
#include "lbm_solver/immersed/weight.h"
#include "lbm_solver/solver/fluid.h"
#include "tests/support/meshes.h"

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
  Fluid fluid(kDomain, {.solid_term = SolidTerm::LayeredResistance, .parameters = {.tau = 0.8}});
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
  const ImmersedWeight viscous(WeightRule::Viscous), fraction(WeightRule::Fraction);
  EXPECT_EQ(viscous(0.0, 0.3), 0.0);
  EXPECT_EQ(viscous(1.0, 0.3), 1.0);
  EXPECT_NEAR(viscous(0.5, 0.3), 0.5 * 0.3 / 0.8, 1e-15);
  EXPECT_NEAR(fraction(0.3, 0.3), 0.3, 1e-16);
}

TEST(CoverMap, SolidsThatShareACellAreOneThereAndAWallIsAWall) {
  CoverMap cover(kDomain);
  const auto discs = cluster();
  cover.update(discs);
  double together = 0.0;
  for (const Body& disc : discs) {
    CoverMap alone(kDomain);
    alone.update(std::vector<Body>{disc});
    together += alone.solid_fraction(24, 22);
  }
  EXPECT_GT(together, 1.0);  // two of the discs overlap there
  EXPECT_EQ(cover.solid_fraction(24, 22), 1.0);
  EXPECT_GT(cover.cell(24, 22).velocity.norm(), 0.0);
  cover.add_wall({24, 20, 0}, {30, 23, 1});
  EXPECT_EQ(cover.cell(24, 22).cover, kWall);
  EXPECT_EQ(cover.cell(24, 22).velocity.norm(), 0.0);
  EXPECT_EQ(cover.solid_fraction(24, 22), 1.0);
  EXPECT_NE(cover.cell(23, 22).cover, kWall);
}

TEST(CoverMap, ACellOfSeveralSolidsHasTheirFractionsAndTheirMeanVelocity) {
  CoverMap cover(kDomain);
  const auto discs = cluster();
  cover.update(discs);
  std::deque<CoverMap> alone;  // a map of each disc
  for (const Body& disc : discs) alone.emplace_back(kDomain).update(std::vector<Body>{disc});
  int of_two = 0, of_three = 0;
  for (int y = 0; y < kDomain.ny; ++y)
    for (int x = 0; x < kDomain.nx; ++x) {
      int solids = 0;
      double fractions = 0.0;
      Vec3 velocity;
      for (const CoverMap& map : alone) {
        const double fraction = map.solid_fraction(x, y);
        if (fraction == 0.0) continue;
        ++solids;
        fractions += fraction;
        velocity += fraction * map.cell(x, y).velocity;
      }
      EXPECT_NEAR(cover.solid_fraction(x, y), std::min(1.0, fractions), 1e-15) << x << ' ' << y;
      if (solids == 0) continue;
      const Vec3 mean = velocity / fractions;
      EXPECT_NEAR((cover.cell(x, y).velocity - mean).norm(), 0.0, 1e-15) << x << ' ' << y;
      of_two += solids == 2;
      of_three += solids == 3;
    }
  EXPECT_GT(of_two, 5);
  EXPECT_GT(of_three, 0);
}

TEST(CoverMap, WhatWasThereBeforeLeavesNoTrace) {
  const auto discs = cluster();
  CoverMap fresh(kDomain), used(kDomain);
  fresh.update(discs);
  for (int step = 25; step >= 0; --step) {  // comes from elsewhere, each at a speed of its own
    auto before = discs;
    for (std::size_t i = 0; i < before.size(); ++i)
      before[i].centre += step * Vec3(0.37 + 0.11 * i, 0.53 - 0.4 * i);
    if (step % 7 == 3) before.pop_back();  // the last one is away for a while
    used.update(before);
  }
  for (int y = 0; y < kDomain.ny; ++y)
    for (int x = 0; x < kDomain.nx; ++x) {
      EXPECT_EQ(used.cell(x, y).cover, fresh.cell(x, y).cover) << x << ' ' << y;
      EXPECT_EQ(used.cell(x, y).velocity, fresh.cell(x, y).velocity) << x << ' ' << y;
    }
  EXPECT_EQ(used.covered_blocks(), fresh.covered_blocks());
}

TEST(CoverMap, SolidsShareTheForceOfACellByTheirFractions) {
  CoverMap cover(kDomain);
  cover.update(cluster());
  int shared = 0;
  for (int y = 0; y < kDomain.ny; ++y)
    for (int b = 0; b < cover.blocks_per_row(); ++b) {
      CoverBlock* const first = cover.row(y, 0)[b];
      if (!first || !first->next) continue;
      ++shared;
      const auto all = cover.merge<2>(*first);
      double whole[2] = {}, parts[2] = {}, by_hand = 0.0;
      Pack force[2] = {Pack(0.3) * lane_numbers() + Pack(1.0), Pack(-0.2) * lane_numbers()};
      for (int lane = 0; lane < kPackWidth; ++lane) {
        if (all.scale[lane] == 0.0) continue;
        for (int a = 0; a < 2; ++a) whole[a] += force[a][lane];
        by_hand += force[0][lane] * fraction_of(first->cover[lane]) * all.scale[lane];
      }
      cover.split<2>(*first, all.scale, force);
      EXPECT_NEAR(first->sums[0], by_hand, 1e-14);
      for (auto* block = first; block; block = block->next)
        for (int a = 0; a < 2; ++a) parts[a] += block->sums[a];
      for (int a = 0; a < 2; ++a) EXPECT_NEAR(parts[a], whole[a], 1e-14);
    }
  EXPECT_GT(shared, 5);
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
  CoverMap cover(kDomain);
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

TEST(CoverMap, GrowsByOneDiscAtATime) {
  CoverMap cover(kDomain);
  std::vector<Body> discs;
  for (int i = 0; i < 9; ++i) {
    discs.push_back({i + 1, {4.0 + 5.0 * i, 20.0}, 2.0, {0, 0}});
    cover.update(discs);
    for (int k = 0; k < 9; ++k)
      EXPECT_EQ(cover.solid_fraction(4 + 5 * k, 20), k <= i ? 1.0 : 0.0) << i << ' ' << k;
  }
}

TEST(CoverMap, AMeshThatMovesComesBeforeTheBodies) {
  CoverMap cover(kDomain);
  const auto shape = [] {
    const auto mesh = std::make_shared<const TriangleMesh>(test::sphere_mesh({20, 20, 0}, 4, 1));
    return std::make_unique<MovingShape>(MeshSolid{mesh, false}, RadiusShift{});
  };
  cover.add(shape());
  cover.update(cluster());
  EXPECT_THROW(cover.add(shape()), std::logic_error);
}

/// Bytes of the heap that this process has in use, by the allocator's own account; 0 where the
/// allocator keeps none (under sanitizers).
double heap() {
#if defined(__GLIBC__) && __GLIBC_PREREQ(2, 33)
  const struct mallinfo2 info = mallinfo2();
  return static_cast<double>(info.uordblks) + static_cast<double>(info.hblkhd);
#else
  return 0.0;
#endif
}

TEST(CoverMap, TellsTheMemoryThatItHolds) {
  const Domain box{64, 64, Side::Periodic, Side::Periodic, 64, Side::Periodic};
  std::vector<Body> spheres;
  for (int k = 0; k < 343; ++k)
    spheres.push_back({k + 1, {9.1 * (k % 7), 9.1 * (k / 7 % 7), 9.1 * (k / 49)}, 3.0});
  const MeshSolid ball{
      std::make_shared<const TriangleMesh>(test::sphere_mesh({32.0, 32.0, 32.0}, 12.0, 2))};
  const double before = heap();
  if (before == 0.0) GTEST_SKIP() << "the allocator tells nothing";
  CoverMap cover(box);
  cover.add(Geometry{ball});
  cover.add(std::make_unique<MovingShape>(ball, RadiusShift{}));
  Pose pose{.pivot = {32.0, 32.0, 32.0}};
  for (int step = 0; step < 3; ++step) {  // the lists of a body that moves are there twice
    cover.move(std::vector{pose});
    cover.update(spheres);
    pose.shift.y() += 0.7;
    for (Body& b : spheres) b.centre.x() += 0.7;
  }
  const double taken = heap() - before, told = static_cast<double>(cover.bytes());
  std::printf("343 spheres and a mesh: %.0f bytes of the heap, %.0f told\n", taken, told);
  // The allocator adds 16 bytes to each list, of which a body has three, and up to 64 to align one.
  EXPECT_NEAR(told / taken, 1.0, 0.03);
}

TEST(CoverMap, NextCoveredSkipsPureFluid) {
  CoverMap cover(kDomain);
  cover.update(std::vector<Body>{{1, {40.5, 20.0}, 2.0, {0, 0}}});
  EXPECT_EQ(cover.next_covered(20, 0, 0), 38 / kPackWidth);
  EXPECT_EQ(cover.next_covered(3, 0, 0), cover.blocks_per_row());
}

}  // namespace
