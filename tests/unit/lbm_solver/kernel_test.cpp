// SPDX-License-Identifier: GPL-2.0-or-later
/// Every row of the kernel table, on every combination of sides and on odd sizes, against the naive
/// reference from a random state.
#include <gtest/gtest.h>
#include <omp.h>

#include <random>

#include "lbm_solver/immersed/solid_term.h"
#include "lbm_solver/solver/fluid.h"
#include "tests/reference/naive_lattice.h"

namespace {

using namespace lbm;

constexpr double kTau = 0.65, kMagic = 3.0 / 16.0;

std::vector<Disc> three_discs(const Domain& d) {
  // one inside, one across the sides' corner (an image each where periodic), one overlapping the
  // first
  return {{1, {0.55 * d.nx, 0.5 * d.ny}, 4.3, {0.02, -0.01}, 0.003},
          {2, {0.4, 0.7}, 2.6, {-0.01, 0.02}, -0.002},
          {3, {0.55 * d.nx + 6.1, 0.5 * d.ny + 1.2}, 2.2, {0.0, 0.01}, 0.0}};
}

/// The same random state in both, near a moving fluid but far from equilibrium.
void randomise(Fluid& fluid, test::NaiveLattice& naive) {
  const Domain& d = fluid.domain();
  std::mt19937 random(11);
  std::uniform_real_distribution<double> noise(-1.0, 1.0);
  for (int y = 0; y < d.ny; ++y)
    for (int x = 0; x < d.nx; ++x) {
      const auto eq = test::naive_equilibrium(1.0 + 0.01 * noise(random),
                                              {0.05 * noise(random), 0.05 * noise(random)});
      for (int q = 0; q < 9; ++q) {
        const double f = eq[q] * (1.0 + 0.02 * noise(random));
        naive.cell(x, y)[q] = f;
        fluid.arriving(q, x, y) = f - D2Q9::w[q];
      }
    }
}

/// Copies the cover map's records cell by cell, so that only the sweep is under test.
void copy_cover(const CoverMap& cover, const Domain& d, test::NaiveLattice& naive) {
  for (int y = 0; y < d.ny; ++y)
    for (int x = 0; x < d.nx; ++x) {
      const auto* block = cover.block(y, x / kPackWidth);
      const int lane = x % kPackWidth;
      naive.cover(x, y) = {};
      if (block && block->weight[lane] > 0.0)
        naive.cover(x, y) = {block->weight[lane],
                             block->layer[lane] <= 0.0,
                             block->layer[lane] < 0.0,
                             {block->us[lane], block->vs[lane]}};
    }
}

double largest_difference(Fluid& fluid, test::NaiveLattice& naive) {
  double largest = 0.0;
  const Domain& d = fluid.domain();
  for (int y = 0; y < d.ny; ++y)
    for (int x = 0; x < d.nx; ++x)
      for (int q = 0; q < 9; ++q)
        largest =
            std::max(largest, std::abs(fluid.arriving(q, x, y) + D2Q9::w[q] - naive.cell(x, y)[q]));
  return largest;
}

double largest_force_difference(const CoverMap& cover, const Domain& d, test::NaiveLattice& naive) {
  double largest = 0.0;
  for (int y = 0; y < d.ny; ++y)
    for (int x = 0; x < d.nx; ++x) {
      const auto* block = cover.block(y, x / kPackWidth);
      const int lane = x % kPackWidth;
      const Vec2 force = block ? Vec2(block->fx[lane], block->fy[lane]) : Vec2(0.0, 0.0);
      largest = std::max(largest, (force - naive.force(x, y)).cwiseAbs().maxCoeff());
    }
  return largest;
}

std::vector<KernelChoice> all_rows() {
  std::vector<KernelChoice> rows;
  struct Solids {
    std::string term;
    WeightRule weight = WeightRule::Viscous;
  };
  std::vector<Solids> all_solids{{"none"}, {"noble_torczynski", WeightRule::Fraction}};
  for (const std::string& term : known_solid_terms()) all_solids.push_back({term});
  for (const std::string& collision : known_collisions())
    for (const char* turbulence : {"none", "smagorinsky"})
      for (const bool force : {false, true})
        for (const auto& [term, weight] : all_solids)
          rows.push_back(
              {collision, turbulence, force, term, {kTau, kMagic, 0.17, 2e-4, -1e-4}, weight});
  return rows;
}

std::string name_of(const KernelChoice& c) {
  return c.collision + (c.turbulence == "none" ? "" : "_les") + (c.force ? "_force" : "") + "_" +
         c.solid_term + (c.weight == WeightRule::Fraction ? "_fraction" : "");
}

class KernelTest : public testing::TestWithParam<KernelChoice> {};

TEST_P(KernelTest, EqualsTheNaiveReference) {
  const KernelChoice& choice = GetParam();
  const bool solids = choice.solid_term != "none";
  for (const Side side_x : {Side::Periodic, Side::Wall})
    for (const Side side_y : {Side::Periodic, Side::Wall})
      for (const auto& [nx, ny] : {std::pair{37, 21}, {32, 17}, {19, 24}}) {
        const Domain domain{nx, ny, side_x, side_y};
        Fluid fluid(domain, choice);
        test::NaiveLattice naive(domain, choice);
        randomise(fluid, naive);
        ASSERT_EQ(largest_difference(fluid, naive), 0.0) << "initial state";
        auto discs = three_discs(domain);
        for (int step = 0; step < 7; ++step) {
          if (solids) {
            fluid.place(discs);
            copy_cover(*fluid.cover(), domain, naive);
          }
          fluid.step();
          naive.step();
          // round-off of seven steps with sums of nine terms of order one: a few 1e-16 each
          EXPECT_LT(largest_difference(fluid, naive), 2e-14) << nx << 'x' << ny << " step " << step;
          if (solids) {
            EXPECT_LT(largest_force_difference(*fluid.cover(), domain, naive), 1e-14);
          }
          for (Disc& d : discs) d.centre += d.velocity;
        }
      }
}

INSTANTIATE_TEST_SUITE_P(Table, KernelTest, testing::ValuesIn(all_rows()),
                         [](const auto& info) { return name_of(info.param); });

TEST(KernelTable, NamesTheSolidTermsWhereOneIsMissing) {
  try {
    make_kernel({"trt", "none", false, "ladd", {}});
    FAIL();
  } catch (const std::invalid_argument& e) {
    EXPECT_NE(std::string(e.what()).find("superposition"), std::string::npos) << e.what();
  }
}

TEST(KernelTable, NamesItsRowsWhereOneIsMissing) {
  try {
    make_kernel({"mrt", "none", false, "holdych", {}});
    FAIL();
  } catch (const std::invalid_argument& e) {
    EXPECT_NE(std::string(e.what()).find("trt + laminar + no force + solids"), std::string::npos)
        << e.what();
  }
}

TEST(Fluid, SameBitsStepByStepAndTogether) {
  omp_set_num_threads(2);
  for (const bool lid : {false, true}) {  // with a pass between the sweeps, or without
    const Domain domain{21, 14, Side::Periodic, Side::Wall};
    const KernelChoice choice{"trt", "none", false, "none", {kTau, kMagic, 0.0, 0.0, 0.0}};
    Fluid one(domain, choice), together(domain, choice);
    test::NaiveLattice unused(domain, choice);
    for (Fluid* fluid : {&one, &together}) {
      randomise(*fluid, unused);
      if (lid)
        fluid->add(std::make_unique<VelocityPatch>(
            side_links(domain.nx, domain.ny, SideName::Top, 0, domain.nx, true), Vec2(0.01, 0.0),
            false, 0, domain.nx, InTime{0.0, 30.0}));
    }
    for (int step = 0; step < 17; ++step) one.step();
    together.advance(6);
    together.advance(11);
    EXPECT_TRUE(one.state() == together.state()) << lid;
  }
  omp_set_num_threads(1);
}

TEST(Kernel, SameBitsWithAnyNumberOfThreads) {
  const Domain domain{45, 33, Side::Periodic, Side::Wall};
  std::vector<std::vector<double>> states;
  for (const int threads : {1, 2, 3}) {
    omp_set_num_threads(threads);
    const KernelChoice choice{
        "trt", "none", false, "layered_holdych", {kTau, kMagic, 0.0, 0.0, 0.0}};
    Fluid fluid(domain, choice);
    test::NaiveLattice unused(domain, choice);
    randomise(fluid, unused);
    std::vector<double> all;
    for (int step = 0; step < 20; ++step) {
      fluid.place(three_discs(domain));
      fluid.step();
      for (const auto& l : fluid.loads())
        all.insert(all.end(), {l.force.x(), l.force.y(), l.torque});
    }
    for (int y = 0; y < domain.ny; ++y)
      for (int x = 0; x < domain.nx; ++x) all.push_back(fluid.arriving(5, x, y));
    states.push_back(all);
  }
  omp_set_num_threads(1);
  EXPECT_EQ(states[1], states[0]);
  EXPECT_EQ(states[2], states[0]);
}

}  // namespace
