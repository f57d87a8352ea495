// SPDX-License-Identifier: GPL-2.0-or-later
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "tests/support/openings.h"

namespace {

using namespace lbm;

KernelChoice kernel(CollisionOperator collision, SolidTerm solid_term = SolidTerm::None) {
  return {.collision = collision, .solid_term = solid_term, .parameters = {.tau = 0.7}};
}

TEST(SideLinks, ASlotKeepsItsEdgesNoSlip) {
  // cells 3 … 6 of the left side: each has one straight link, and diagonals except those across the
  // ends
  const Domain domain{20, 10, Side::Wall, Side::Wall};
  const auto links = side_links(lattice(VelocitySet::D2Q9), domain, Block::whole(domain),
                                test::part(SideName::Left, 3, 7));
  EXPECT_EQ(links.size(), 4U + 2 * 3);
  for (const Link& l : links) {
    EXPECT_EQ(l.cell[0], 0);
    EXPECT_EQ(D2Q9::c[l.q][0], 1);
    EXPECT_GT(l.at[0], 3.0);
    EXPECT_LT(l.at[0], 7.0);
  }
}

TEST(SideLinks, CornersOfTheBoxBelongToTheWalls) {
  const auto links = [](Side across) {
    const Domain domain{20, 10, across, Side::Wall};
    return side_links(lattice(VelocitySet::D2Q9), domain, Block::whole(domain),
                      Opening::whole(domain, SideName::Top));
  };
  EXPECT_EQ(links(Side::Wall).size(), 20U + 2 * 19);
  EXPECT_EQ(links(Side::Periodic).size(), 3U * 20);
}

/// Sum of rho - 1 over the lattice.
double mass(Fluid& fluid) {
  return fluid.extremes().mass_excess;
}

TEST(Ledger, MassOfAnOpenBoxIsAccountedForToRoundOff) {
  Fluid fluid({40, 24, Side::Wall, Side::Wall}, kernel(CollisionOperator::Trt));
  test::add_velocity(fluid, test::part(SideName::Left, 4, 20), {0.05, 0.0}, true, {50.0, 0.0});
  test::add_pressure(fluid, test::part(SideName::Right, 0, 12), 0.002);
  test::add_outflow(fluid, test::part(SideName::Right, 12, 24), 0.0, 0.01);
  for (int step = 0; step < 2000; ++step) fluid.step();
  EXPECT_NEAR(mass(fluid), fluid.mass_in(), 1e-12 * 40 * 24);
  EXPECT_GT(std::abs(fluid.patches()[0]->mass_in()), 10.0);  // a good deal went through
}

TEST(Ledger, APressureJumpMakesNoMass) {
  Fluid fluid({24, 16, Side::Periodic, Side::Wall}, kernel(CollisionOperator::Trt));
  for (const SideName side : {SideName::Left, SideName::Right})
    fluid.add(std::make_unique<PressureJumpPatch>(fluid.links(test::part(side, 0, 16)), side,
                                                  side == SideName::Left ? 1e-3 : -1e-3, InTime{}));
  for (int step = 0; step < 3000; ++step) fluid.step();
  // the even terms of both sides are those of slightly different velocities: 4.5 (c·u)² of 1e-3 of
  // each
  EXPECT_NEAR(mass(fluid), 0.0, 1e-6 * 24 * 16);
  EXPECT_GT(fluid.extremes().max_speed, 1e-3);
}

/// Populations of a box that is the first one turned by 90° counter-clockwise, or mirrored in x.
enum class Turn { Quarter, Mirror };
struct Image {
  int x, y, q;
};
Image image(Turn turn, int x, int y, int q, int nx, int ny) {
  const int cx = D2Q9::c[q][0], cy = D2Q9::c[q][1];
  const int tx = turn == Turn::Quarter ? -cy : -cx, ty = turn == Turn::Quarter ? cx : cy;
  int to = 0;
  while (D2Q9::c[to][0] != tx || D2Q9::c[to][1] != ty) ++to;
  return turn == Turn::Quarter ? Image{ny - 1 - y, x, to} : Image{nx - 1 - x, y, to};
}

class SymmetryTest : public testing::TestWithParam<CollisionOperator> {};

TEST_P(SymmetryTest, ATurnedOrMirroredStateGivesTheTurnedResult) {
  const int nx = 21, ny = 14;
  for (const Side side : {Side::Periodic, Side::Wall})
    for (const Turn turn : {Turn::Quarter, Turn::Mirror})
      for (const double smagorinsky : {0.0, 0.1}) {
        const bool quarter = turn == Turn::Quarter;
        KernelChoice choice{.collision = GetParam(),
                            .parameters = {.tau = 0.55, .smagorinsky = smagorinsky}};
        Fluid a({nx, ny, side, side}, choice);
        Fluid b({quarter ? ny : nx, quarter ? nx : ny, side, side}, choice);
        std::mt19937 random(7);
        std::uniform_real_distribution<double> noise(-1e-3, 1e-3);
        const auto each = [&](auto&& f) {
          for (int y = 0; y < ny; ++y)
            for (int x = 0; x < nx; ++x)
              for (int q = 0; q < D2Q9::Q; ++q) {
                const Image to = image(turn, x, y, q, nx, ny);
                f(a.arriving(q, x, y), b.arriving(to.q, to.x, to.y));
              }
        };
        each([&](const Population& p, const Population& q) {
          p = noise(random);
          q = p;
        });
        for (int step = 0; step < 20; ++step) {
          a.step();
          b.step();
        }
        double largest = 0.0;
        each([&](double p, double q) { largest = std::max(largest, std::abs(p - q)); });
        // deviations of 1e-3 have a round-off of 1e-19; central moments rebuild whole populations,
        // up to 4/9, in sums of some ten terms
        EXPECT_LT(largest, GetParam() == CollisionOperator::CentralMoment ? 1e-15 : 1e-17);
      }
}
INSTANTIATE_TEST_SUITE_P(Operators, SymmetryTest, testing::ValuesIn(choices<CollisionOperator>()));

TEST(Blocks, AreWallsHalfWayBetweenTheCells) {
  // two rows of block at the bottom of a box make a box that is two rows lower
  const int nx = 13, ny = 12;
  KernelChoice plain{.force = true, .parameters = {.tau = 0.8, .force_x = 1e-5}}, with = plain;
  with.solid_term = SolidTerm::LayeredHoldych;
  Fluid small({nx, ny, Side::Periodic, Side::Wall}, plain);
  Fluid large({nx, ny + 2, Side::Periodic, Side::Wall}, with);
  large.add_wall({0, 0, 0}, {nx, 2, 1});
  large.place({});
  for (int step = 0; step < 6000; ++step) {
    small.step();
    large.step();
  }
  for (int y = 0; y < ny; ++y)
    // bounce-back in the block takes one step more than at a side: equal once it is steady
    EXPECT_NEAR(small.cell(5, y).u.x(), large.cell(5, y + 2).u.x(), 1e-9) << y;
  EXPECT_GT(small.cell(5, ny / 2).u.x(), 1e-3);
}

}  // namespace
