// SPDX-License-Identifier: MIT
#include "protocol/wire/routing.h"

#include <gtest/gtest.h>

#include <random>

namespace {

using protocol::Hello;
using protocol::touches;
using protocol::Vec3;

Hello subdomain(std::array<std::uint8_t, 3> periodic, Vec3 lo, Vec3 hi) {
  Hello h;
  h.dimension = 2;
  h.box_hi = {8.0, 4.0, 1.0};
  h.periodic = periodic;
  h.subdomain_lo = lo;
  h.subdomain_hi = hi;
  h.reach = 0.25;
  return h;
}

/// Tries every image within two boxes.
bool touches_by_trying(const Hello& h, const Vec3& x, double radius) {
  const double grown = radius + h.reach;
  const int ix = h.periodic[0] ? 2 : 0, iy = h.periodic[1] ? 2 : 0;
  for (int i = -ix; i <= ix; ++i)
    for (int j = -iy; j <= iy; ++j) {
      const double px = x[0] + 8.0 * i, py = x[1] + 4.0 * j;
      if (px >= h.subdomain_lo[0] - grown && px <= h.subdomain_hi[0] + grown &&
          py >= h.subdomain_lo[1] - grown && py <= h.subdomain_hi[1] + grown)
        return true;
    }
  return false;
}

TEST(Routing, AgreesWithTryingEveryImage) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> x(-8.0, 16.0), y(-4.0, 8.0), r(0.05, 1.0);
  int hits = 0;
  for (int trial = 0; trial < 20000; ++trial) {
    const Hello h =
        subdomain({random() % 2 == 0, random() % 2 == 0, 1}, {2.0, 0.0, 0.0}, {4.0, 2.0, 1.0});
    const Vec3 at{x(random), y(random), 0.0};
    const double radius = r(random);
    const bool expected = touches_by_trying(h, at, radius);
    EXPECT_EQ(touches(h, at, radius), expected) << at[0] << ' ' << at[1] << ' ' << radius;
    hits += expected;
  }
  EXPECT_GT(hits, 1000);
}

TEST(Routing, ParticleOnAPeriodicCornerTouchesAllFourQuarters) {
  for (const double x : {0.0, 8.0})
    for (const double y : {0.0, 4.0})
      for (const double lo_x : {0.0, 4.0})
        for (const double lo_y : {0.0, 2.0})
          EXPECT_TRUE(touches(subdomain({1, 1, 1}, {lo_x, lo_y, 0}, {lo_x + 4, lo_y + 2, 1}),
                              {x, y, 0.0}, 0.1));
}

}  // namespace
