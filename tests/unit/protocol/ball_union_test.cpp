// SPDX-License-Identifier: MIT
#include "protocol/wire/ball_union.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>
#include <vector>

namespace {

using namespace protocol;
using std::numbers::pi;

TEST(BallUnion, OfOneIsTheFormula) {
  const Ball ball{1, {0.3, -0.2, 0.1}, 0.7};
  const auto m = moments_of_union({&ball, 1}, 3);
  EXPECT_DOUBLE_EQ(m.volume, 4.0 / 3.0 * pi * std::pow(0.7, 3));
  EXPECT_EQ(m.centroid, ball.x);
  EXPECT_DOUBLE_EQ(m.second[0], 0.2 * 0.49 + 0.09);
  const auto disc = moments_of_union({&ball, 1}, 2, 0.5);
  EXPECT_DOUBLE_EQ(disc.volume, 0.5 * pi * 0.49);
  EXPECT_DOUBLE_EQ(disc.second[5], -0.06);
}

/// Two of radius 1, `apart` along a direction that lies in no plane of the grid.
std::vector<Ball> pair(double apart, bool flat) {
  const double n[] = {0.6, flat ? 0.8 : 0.64, flat ? 0.0 : 0.48};
  std::vector<Ball> balls(2);
  for (int i = 0; i < 2; ++i) {
    balls[i].radius = 1.0;
    for (int k = 0; k < 3; ++k) balls[i].x[k] = (i - 0.5) * apart * n[k];
  }
  return balls;
}

TEST(BallUnion, OfTwoHasTheVolumeLessTheLens) {
  // 1e-4: the error of the quadrature, a hundredth of what a clump's volume may be wrong by.
  for (const double d : {0.2, 1.0, 1.7, 2.0}) {
    const double cap = 1.0 - 0.5 * d, lens = 2.0 * pi * cap * cap * (3.0 - cap) / 3.0;
    EXPECT_NEAR(moments_of_union(pair(d, false), 3).volume / (8.0 / 3.0 * pi - lens), 1.0, 1e-4);
    const double chord = 2.0 * std::acos(0.5 * d) - 0.5 * d * std::sqrt(4.0 - d * d);
    EXPECT_NEAR(moments_of_union(pair(d, true), 2).volume / (2.0 * pi - chord), 1.0, 1e-4);
  }
}

TEST(BallUnion, HasTheMomentsOfACloudOfPoints) {
  std::vector<Ball> balls{
      {1, {0.4, 0.1, -0.3}, 0.9}, {2, {-0.5, 0.6, 0.2}, 0.7}, {3, {0.1, -0.8, 0.4}, 0.5}};
  std::mt19937 random(3);
  std::uniform_real_distribution<double> place(-1.6, 1.6);
  double count = 0.0, first[3] = {}, xy = 0.0, zz = 0.0;
  constexpr int tries = 2000000;
  for (int n = 0; n < tries; ++n) {
    const double p[3] = {place(random), place(random), place(random)};
    bool in = false;
    for (const Ball& b : balls)
      in = in || std::hypot(p[0] - b.x[0], p[1] - b.x[1], p[2] - b.x[2]) < b.radius;
    if (!in) continue;
    ++count;
    for (int k = 0; k < 3; ++k) first[k] += p[k];
    xy += p[0] * p[1];
    zz += p[2] * p[2];
  }
  const auto m = moments_of_union(balls, 3);
  // five times the error of so many samples
  EXPECT_NEAR(m.volume, count / tries * std::pow(3.2, 3), 5 * 0.010);
  for (int k = 0; k < 3; ++k) EXPECT_NEAR(m.centroid[k], first[k] / count, 5 * 0.0012);
  EXPECT_NEAR(m.second[5], xy / count, 5 * 0.0007);
  EXPECT_NEAR(m.second[2], zz / count, 5 * 0.0006);
}

TEST(BallUnion, BoundingRadiusReachesTheFarthestRim) {
  EXPECT_DOUBLE_EQ(bounding_radius(std::vector<Ball>{{1, {3.0, 4.0, 0.0}, 1.0}, {2, {}, 2.0}}),
                   6.0);
}

}  // namespace
