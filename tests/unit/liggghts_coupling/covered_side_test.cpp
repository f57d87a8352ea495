// SPDX-License-Identifier: GPL-2.0-or-later
#include "liggghts_coupling/host/covered_side.h"

#include <gtest/gtest.h>

namespace {

using dem::CoveredSide;
using dem::Place;

const Place kLow{1.0, 2.0, 3.0}, kHigh{3.0, 5.0, 4.0};

/// A floor across z of the box, from x = 1 on.
void add_floor(CoveredSide& side, double to_x, double z) {
  side.add({Place{1.0, 2.0, z}, Place{to_x, 2.0, z}, Place{to_x, 5.0, z}});
  side.add({Place{1.0, 2.0, z}, Place{1.0, 5.0, z}, Place{to_x, 5.0, z}});
}

TEST(CoveredSide, AFloorOfTwoTrianglesCoversTheSideBelow) {
  for (const double z : {2.9999, 3.0, 3.4}) {
    CoveredSide side(kLow, kHigh, 3, 4, 0.5, 0.001);
    EXPECT_FALSE(side.covered());
    add_floor(side, 3.0, z);
    EXPECT_TRUE(side.covered()) << z;
  }
}

TEST(CoveredSide, WhatHasAGapOrLiesBehindTheParticlesCoversNothing) {
  CoveredSide gap(kLow, kHigh, 3, 4, 0.5, 0.001);
  add_floor(gap, 2.8, 3.2);
  EXPECT_FALSE(gap.covered());
  CoveredSide behind(kLow, kHigh, 3, 4, 0.5, 0.001);
  add_floor(behind, 3.0, 3.6);
  EXPECT_FALSE(behind.covered());
  CoveredSide above(kLow, kHigh, 3, 5, 0.5, 0.001);  // seen from z = 4
  add_floor(above, 3.0, 3.6);
  EXPECT_TRUE(above.covered());
}

// Two parts, as two ranks have them; the second adds what the first has met.
TEST(CoveredSide, PartsOfAMeshAddUp) {
  CoveredSide one(kLow, kHigh, 3, 4, 0.5, 0.001), other = one;
  one.add({Place{1.0, 2.0, 3.1}, Place{3.0, 2.0, 3.1}, Place{3.0, 5.0, 3.1}});
  other.add({Place{1.0, 2.0, 3.1}, Place{1.0, 5.0, 3.1}, Place{3.0, 5.0, 3.1}});
  EXPECT_FALSE(one.covered());
  EXPECT_FALSE(other.covered());
  for (std::size_t i = 0; i < one.met().size(); ++i) other.met()[i] |= one.met()[i];
  EXPECT_TRUE(other.covered());
}

// The layer of a box in two dimensions is looked at in its middle.
TEST(CoveredSide, InTwoDimensionsALineDoes) {
  const Place low{0.0, 0.0, -0.5}, high{1.0, 1.0, 0.5};
  CoveredSide side(low, high, 2, 2, 0.3, 0.001);
  side.add({Place{0.0, 0.1, -0.2}, Place{1.0, 0.2, -0.2}, Place{1.0, 0.2, 0.2}});
  side.add({Place{0.0, 0.1, -0.2}, Place{0.0, 0.1, 0.2}, Place{1.0, 0.2, 0.2}});
  EXPECT_TRUE(side.covered());
}

}  // namespace
