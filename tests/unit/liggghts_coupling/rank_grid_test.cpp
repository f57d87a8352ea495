// SPDX-License-Identifier: GPL-2.0-or-later
#include "liggghts_coupling/host/rank_grid.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace {

using namespace dem;

std::vector<double> counted(const std::vector<RankGrid>& grids, int ranks, int layers) {
  std::vector<double> counts(grids.size() * static_cast<std::size_t>(ranks), 0.0);
  for (int z = 0; z < layers; ++z)
    for (int y = 0; y < 10; ++y)
      for (int x = 0; x < 10; ++x)
        count_place(grids, {(x + 0.5) / 10.0, (y + 0.5) / 10.0, (z + 0.5) / 40.0}, counts);
  return counts;
}

TEST(RankGrid, HasEveryGridOfSoManyRanks) {
  EXPECT_EQ(grids_of(1, 3), (std::vector<RankGrid>{{1, 1, 1}}));
  EXPECT_EQ(grids_of(3, 2), (std::vector<RankGrid>{{1, 3, 1}, {3, 1, 1}}));
  const auto twelve = grids_of(12, 3);
  EXPECT_EQ(twelve.size(), 18U);  // ordered triples of divisors with product 12
  for (const auto& [x, y, z] : twelve) EXPECT_EQ(x * y * z, 12);
  EXPECT_EQ(grids_of(12, 2).size(), 6U);
}

// 1 000 grains fill the lowest quarter of the box: cut across z one of four ranks has all.
TEST(RankGrid, CountsWhatEachRankWouldOwn) {
  const auto grids = grids_of(4, 3);
  const auto counts = counted(grids, 4, 10);
  for (std::size_t g = 0; g < grids.size(); ++g) {
    const std::span<const double> of(&counts[4 * g], 4);
    double expected = 1.0;
    if (grids[g][2] == 2) expected = 2.0;  // the lower half of each has all
    if (grids[g][2] == 4) expected = 4.0;
    if (grids[g][0] == 4 || grids[g][1] == 4) expected = 1.2;  // three of ten layers
    EXPECT_DOUBLE_EQ(busiest_of(of), expected) << grids[g][0] << grids[g][1] << grids[g][2];
  }
  std::vector<double> beyond(4, 0.0);  // places at and beyond the box's ends
  count_place(std::vector<RankGrid>{{4, 1, 1}}, {-0.1, 2.0, 1.0}, beyond);
  count_place(std::vector<RankGrid>{{4, 1, 1}}, {1.0, 0.0, 0.0}, beyond);
  EXPECT_EQ(beyond, (std::vector<double>{1.0, 0.0, 0.0, 1.0}));
}

TEST(RankGrid, NamesTheGridThatSharesBest) {
  const auto grids = grids_of(4, 3);
  const auto counts = counted(grids, 4, 10);
  EXPECT_NE(advise_grid(4.0, grids, counts).find("\"processors 2 2 1\""), std::string::npos)
      << advise_grid(4.0, grids, counts);
  EXPECT_EQ(advise_grid(1.2, grids, counts), "");
  EXPECT_EQ(advise_grid(4.0, grids, counted(grids, 4, 3)), "");  // 75 grains a rank
  EXPECT_EQ(busiest_of(std::vector<double>(4, 0.0)), 1.0);
  std::vector<double> heap(4 * grids.size(), 0.0);  // wherever one cuts, one rank has all
  for (int i = 0; i < 500; ++i) count_place(grids, {0.01, 0.01, 0.01}, heap);
  EXPECT_NE(advise_grid(4.0, grids, heap).find("no grid"), std::string::npos);
}

}  // namespace
