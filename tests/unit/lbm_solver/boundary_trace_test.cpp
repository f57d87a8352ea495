// SPDX-License-Identifier: GPL-2.0-or-later
#include "lbm_solver/immersed/boundary_trace.h"

#include <gtest/gtest.h>

#include <random>
#include <set>

namespace {

using namespace lbm;
using Cells = std::set<BoundaryTrace::Cell>;

TEST(BoundaryTrace, FindsTheCellsOnEitherSideOfTheSurface) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> place(30.0, 31.0);
  for (const double radius : {2.5, 5.0, 12.5})
    for (int trial = 0; trial < 200; ++trial) {
      const Vec3 centre(place(random), place(random));
      const auto inside = [&](int x, int y) {
        return (Vec3(x + 0.5, y + 0.5) - centre).squaredNorm() < radius * radius;
      };
      Cells solid, fluid;
      for (int y = 10; y < 50; ++y)
        for (int x = 10; x < 50; ++x)
          for (int dy = -1; dy <= 1; ++dy)
            for (int dx = -1; dx <= 1; ++dx)
              if (inside(x, y) != inside(x + dx, y + dy))
                (inside(x, y) ? solid : fluid).insert({x, y});
      const BoundaryTrace trace = trace_boundary(centre, radius);
      EXPECT_EQ(Cells(trace.solid.begin(), trace.solid.end()), solid) << radius;
      EXPECT_EQ(Cells(trace.fluid.begin(), trace.fluid.end()), fluid) << radius;
    }
}

}  // namespace
