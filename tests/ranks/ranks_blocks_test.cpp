// SPDX-License-Identifier: GPL-2.0-or-later
/// How a box is divided among ranks.
#include <numeric>

#include "lbm_solver/solver/work.h"
#include "tests/ranks/on_ranks.h"

namespace {

using namespace test;

// A packing in the lower half of a box: the cuts move there, and all ranks agree on them.
TEST(Ranks, ShareTheWorkOfAPacking) {
  const Domain domain{48, 40, Side::Periodic, Side::Periodic, 96, Side::Wall};
  const KernelChoice choice = choice_for(VelocitySet::D3Q19, Precision::Double);
  std::vector<Body> bodies;
  for (int i = 0; i < 4 * 3 * 4; ++i)
    bodies.push_back({i + 1,
                      {6.0 + 12.0 * (i % 4), 7.0 + 13.0 * (i / 4 % 3), 6.0 + 12.0 * (i / 12)},
                      5.5,
                      {0.01, 0.0, 0.0},
                      Spin()});
  Fluid whole(domain, choice);
  whole.place(bodies);
  const LayerWork work = work_of(whole);
  for (const auto& axis : work)
    EXPECT_NEAR(std::accumulate(axis.begin(), axis.end(), 0.0),
                std::accumulate(work[2].begin(), work[2].end(), 0.0), 1e-6);
  EXPECT_EQ(work[2][90], 48.0 * 40.0);  // fluid alone
  EXPECT_GT(work[2][40], 1.3 * 48.0 * 40.0);
  for (const Cell3& grid : grids(domain)) {
    const Decomposition ranks(domain, MPI_COMM_WORLD, grid);
    Fluid part(ranks, choice);
    part.place(bodies);
    const LayerWork found = work_of(part);
    for (int a = 0; a < 3 && grid[0] == 1; ++a) EXPECT_EQ(found[a], work[a]);
    const Decomposition balanced = of_equal_work(ranks, found);
    EXPECT_EQ(balanced.grid(), grid);
    EXPECT_LE(imbalance(balanced, found), imbalance(ranks, found) + 1e-12);
    if (grid[2] == world_size()) {  // as near as whole layers come
      EXPECT_GT(imbalance(ranks, found), 1.15);
      EXPECT_LT(imbalance(balanced, found), 1.1);
      EXPECT_LT(balanced.cuts()[2][1], ranks.cuts()[2][1]);
    }
    const LayerWork kept = load_work(save(found), domain);
    EXPECT_EQ(kept, found);
    EXPECT_THROW(load_work(save(found), {48, 40, Side::Wall, Side::Wall, 95}),
                 std::invalid_argument);
  }
}

TEST(Ranks, CutLayersIntoEqualSums) {
  using Cut = std::vector<int>;
  const std::vector<double> even(10, 1.0), half{3, 3, 3, 3, 3, 1, 1, 1, 1, 1},
      peak{0, 0, 0, 0, 90, 0, 0, 0, 0, 0};
  EXPECT_EQ(cuts_of_equal_sums(even, 1), (Cut{0, 10}));
  EXPECT_EQ(cuts_of_equal_sums(even, 2), (Cut{0, 5, 10}));
  EXPECT_EQ(cuts_of_equal_sums(half, 2), (Cut{0, 3, 10}));        // 9 and 11 of 20
  EXPECT_EQ(cuts_of_equal_sums(half, 4), (Cut{0, 2, 4, 6, 10}));  // no block thinner than 2 cells
  EXPECT_EQ(cuts_of_equal_sums(peak, 5), (Cut{0, 2, 4, 6, 8, 10}));
  const Domain box{8, 8, Side::Wall, Side::Wall, 10};
  Cuts cuts = equal_cuts(box, {1, 1, world_size()});
  cuts[2][1] = 1;
  EXPECT_THROW(Decomposition(box, MPI_COMM_WORLD, {1, 1, world_size()}, cuts),
               std::invalid_argument);
}

TEST(Ranks, CutZFirstAndNeverTooThin) {
  EXPECT_EQ(choose_grid({40, 40, Side::Wall, Side::Wall, 40}, 2), (Cell3{1, 1, 2}));
  EXPECT_EQ(choose_grid({40, 40, Side::Wall, Side::Wall, 40}, 4), (Cell3{1, 1, 4}));
  EXPECT_EQ(choose_grid({40, 40, Side::Wall, Side::Wall, 40}, 8), (Cell3{1, 2, 4}));
  EXPECT_EQ(choose_grid({40, 40, Side::Wall, Side::Wall}, 3), (Cell3{1, 3, 1}));
  EXPECT_EQ(choose_grid({4000, 40, Side::Wall, Side::Wall}, 4), (Cell3{4, 1, 1}));
  EXPECT_THROW(choose_grid({4, 4, Side::Wall, Side::Wall}, 7), std::invalid_argument);
}

}  // namespace
