// SPDX-License-Identifier: GPL-2.0-or-later
#include "lbm_solver/immersed/footprint.h"

#include <gtest/gtest.h>

#include <numbers>
#include <random>

#include "lbm_solver/immersed/solid_fraction.h"
#include "tests/reference/disc_area.h"

namespace {

using namespace lbm;

/// What covers a lane of a span.
double cover_of(const Footprint& footprint, const Footprint::Span& span, int lane) {
  return footprint.blocks()[span.first + lane / kPackWidth].cover[lane % kPackWidth];
}
double fraction_in(const Footprint& footprint, const Footprint::Span& span, int lane) {
  return fraction_of(cover_of(footprint, span, lane));
}

/// Dense map of fractions [y][x]; images that share a cell add up.
std::vector<double> fraction_map(const Body& disc, const Domain& d) {
  Footprint footprint;
  footprint.update(disc, d);
  std::vector<double> map(static_cast<std::size_t>(d.nx) * d.ny, 0.0);
  for (const auto& span : footprint.spans())
    for (int k = 0; k < span.count(); ++k)
      if (span.x() + k < d.nx)
        map[static_cast<std::size_t>(span.y) * d.nx + span.x() + k] +=
            fraction_in(footprint, span, k);
  return map;
}

TEST(DiscFraction, ChordsAreNearTheExactArea) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> angle(0.0, 2.0 * std::numbers::pi), offset(-0.7, 0.7);
  double squares = 0.0;
  constexpr int trials = 2000;
  for (int t = 0; t < trials; ++t) {
    const double a = angle(random), r = 5.0 + offset(random);
    const double x = r * std::cos(a), y = r * std::sin(a);
    const double exact = test::exact_fraction(x, y, 5.0), error = disc_fraction(x, y, 5.0) - exact;
    EXPECT_NEAR(test::sampled_fraction(x, y, 5.0, 200), exact, 0.002);  // half a row of points
    squares += error * error;
    EXPECT_LT(std::abs(error), 0.06);  // a corner that both Gauss chords miss
  }
  EXPECT_LT(std::sqrt(squares / trials), 0.007);  // measured for this rule at D = 10: 0.005
}

TEST(DiscFraction, ExactAreasAddUpToTheDisc) {
  for (const double radius : {0.4, 2.0, 5.3}) {
    double area = 0.0;
    for (int j = -8; j < 8; ++j)
      for (int i = -8; i < 8; ++i) area += test::exact_fraction(i + 0.37, j + 0.81, radius);
    EXPECT_NEAR(area, std::numbers::pi * radius * radius, 1e-12 * 100);
  }
}

TEST(SphereFraction, IsNearDenseSampling) {
  std::mt19937 random(5);
  std::normal_distribution<double> part;
  std::uniform_real_distribution<double> offset(-0.86, 0.86);
  double squares = 0.0;
  constexpr int trials = 400, n = 30;
  for (int t = 0; t < trials; ++t) {
    Vec3 at(part(random), part(random), part(random));
    at *= (5.0 + offset(random)) / at.norm();
    int inside = 0;
    for (int i = 0; i < n * n * n; ++i) {
      const Vec3 in_cell(i % n, i / n % n, i / (n * n));
      inside += (at + (in_cell + Vec3(0.5, 0.5, 0.5)) / n - Vec3(0.5, 0.5, 0.5)).norm() < 5.0;
    }
    const double sampled = static_cast<double>(inside) / (n * n * n);
    const double error = sphere_fraction(at.x(), at.y(), at.z(), 5.0) - sampled;
    squares += error * error;
    EXPECT_LT(std::abs(error), 0.06);
  }
  EXPECT_LT(std::sqrt(squares / trials), 0.007);  // 0.005 … 0.006 for this rule at D = 10
}

TEST(SphereFraction, MapAddsUpToTheVolumeInsideAndAcrossACorner) {
  const Domain box{40, 36, Side::Periodic, Side::Periodic, 32, Side::Periodic};
  for (const Vec3& centre : {Vec3(20.3, 17.7, 15.1), Vec3(0.4, 35.8, 31.6)}) {
    Footprint footprint;
    footprint.update({1, centre, 6.3, Vec3()}, box);
    double volume = 0.0;
    for (const auto& block : footprint.blocks())
      for (const double cover : block.cover) volume += fraction_of(cover);
    EXPECT_NEAR(volume / (4.0 / 3.0 * std::numbers::pi * 6.3 * 6.3 * 6.3), 1.0, 2e-3);
  }
}

TEST(DiscFraction, IsOneInsideAndZeroOutside) {
  EXPECT_EQ(disc_fraction(0.0, 0.0, 5.0), 1.0);
  EXPECT_EQ(disc_fraction(5.0, 5.0, 5.0), 0.0);
  EXPECT_EQ(disc_fraction(-6.0, 0.3, 5.0), 0.0);
}

TEST(Footprint, AreaIsThatOfTheDisc) {
  const Domain d{64, 64, Side::Wall, Side::Wall};
  std::mt19937 random(6);
  std::uniform_real_distribution<double> place(28.0, 36.0);
  for (const double radius : {2.0, 5.0, 12.5}) {
    for (int t = 0; t < 50; ++t) {
      double area = 0.0;
      for (const double e :
           fraction_map({1, {place(random), place(random)}, radius, {0, 0}, 0}, d)) {
        EXPECT_GE(e, 0.0);
        EXPECT_LE(e, 1.0);
        area += e;
      }
      // The error of a surface cell, 0.005 at R = 5, falls with the curvature as 1/R; with all of
      // the 8 R surface cells erring to the same side the sum stays below 8 R (0.005 · 5 / R).
      EXPECT_NEAR(area, std::numbers::pi * radius * radius, 0.2) << radius;
    }
  }
}

TEST(Footprint, CrossingPeriodicFacesEdgesAndCornersChangesNoFraction) {
  const Domain d{40, 24, Side::Periodic, Side::Periodic};
  // multiples of 2^-10 cells, so that shifted positions are exact
  const Vec3 inside(17.0 + 311.0 / 1024, 12.0 + 45.0 / 1024);
  const auto reference = fraction_map({1, inside, 5.25, {0, 0}, 0}, d);
  for (const int sx : {0, 18, 20, 23, 57, -19, -60})
    for (const int sy : {0, 9, 12, 14, 35, -13, -36}) {
      const auto map = fraction_map({1, inside + Vec3(sx, sy), 5.25, {0, 0}, 0}, d);
      for (int y = 0; y < d.ny; ++y)
        for (int x = 0; x < d.nx; ++x) {
          const int tx = ((x + sx) % d.nx + d.nx) % d.nx, ty = ((y + sy) % d.ny + d.ny) % d.ny;
          ASSERT_EQ(map[ty * d.nx + tx], reference[y * d.nx + x]) << sx << ' ' << sy;
        }
    }
}

TEST(Footprint, ArmsPointFromTheImageToTheCell) {
  const Domain d{40, 24, Side::Periodic, Side::Periodic};
  const Body disc{1, {0.5, 23.5}, 3.0, {0, 0}, 0};  // across a corner
  Footprint footprint;
  footprint.update(disc, d);
  double area = 0.0;
  for (const auto& span : footprint.spans())
    for (int k = 0; k < span.count(); ++k) {
      if (fraction_in(footprint, span, k) == 0.0) continue;
      EXPECT_LT(std::hypot(span.arm_x + k, span.arm_y), 3.0 + 0.75);
      area += fraction_in(footprint, span, k);
      const CoverBlock& block = footprint.blocks()[span.first + k / kPackWidth];
      EXPECT_EQ(block.arm[0] + k % kPackWidth, span.arm_x + k);  // exact, though a float
      EXPECT_EQ(block.arm[1], span.arm_y);
    }
  EXPECT_NEAR(area, 9.0 * std::numbers::pi, 0.1);
}

TEST(Footprint, TheCoreIsWholeAndDeep) {
  const Domain d{64, 64, Side::Wall, Side::Wall};
  const Body disc{1, {31.7, 30.2}, 9.6, {0, 0}, 0};
  Footprint footprint;
  footprint.update(disc, d);
  int core = 0;
  for (const auto& span : footprint.spans())
    for (int k = 0; k < span.count(); ++k) {
      const double distance = std::hypot(span.arm_x + k, span.arm_y);
      const bool in_core = k >= span.core_begin && k < span.core_end;
      EXPECT_EQ(in_core, distance < 9.6 - kCoreDepth) << distance;
      EXPECT_EQ(in_core, cover_of(footprint, span, k) == kCore);
      core += in_core;
    }
  EXPECT_GT(core, 150);
}

TEST(Footprint, AtRestNothingIsComputedAnew) {
  const Domain d{64, 64, Side::Wall, Side::Wall};
  Footprint footprint;
  EXPECT_TRUE(footprint.update({1, {20.0, 20.0}, 5.0, {0, 0}, 0}, d));
  EXPECT_FALSE(footprint.update({1, {20.0, 20.0}, 5.0, {0.1, 0}, 0}, d));
  EXPECT_TRUE(footprint.update({1, {20.0, 20.1}, 5.0, {0, 0}, 0}, d));
}

TEST(Footprint, PartsBeyondAWallAreCutOff) {
  const Domain d{30, 30, Side::Wall, Side::Wall};
  double area = 0.0;
  for (const double e : fraction_map({1, {15.0, 0.0}, 5.0, {0, 0}, 0}, d)) area += e;
  EXPECT_NEAR(area, 0.5 * 25.0 * std::numbers::pi, 0.1);
  for (const double e : fraction_map({1, {-20.0, 15.0}, 5.0, {0, 0}, 0}, d)) EXPECT_EQ(e, 0.0);
}

}  // namespace
