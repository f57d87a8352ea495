// SPDX-License-Identifier: GPL-2.0-or-later
#include "liggghts_coupling/host/rank_grid.h"

#include <fmt/format.h>

#include <algorithm>
#include <numeric>

namespace dem {
namespace {

constexpr double kBusy = 1.25;     // times the mean from which ranks share badly
constexpr double kBetter = 0.9;    // of that another grid must have at most
constexpr double kFewest = 100.0;  // particles a rank below which it does not matter

}  // namespace

std::vector<RankGrid> grids_of(int ranks, int dimension) {
  std::vector<RankGrid> grids;
  for (int x = 1; x <= ranks; ++x)
    for (int y = 1; ranks % x == 0 && y <= ranks / x; ++y) {
      if (ranks / x % y != 0) continue;
      const int z = ranks / x / y;
      if (dimension == 3 || z == 1) grids.push_back({x, y, z});
    }
  return grids;
}

void count_place(std::span<const RankGrid> grids, const std::array<double, 3>& at,
                 std::vector<double>& counts) {
  std::size_t begin = 0;
  for (const RankGrid& grid : grids) {
    std::array<int, 3> cell{};
    for (int k = 0; k < 3; ++k)
      cell[k] = std::clamp(static_cast<int>(at[k] * grid[k]), 0, grid[k] - 1);
    counts[begin + static_cast<std::size_t>(cell[0] + grid[0] * (cell[1] + grid[1] * cell[2]))] +=
        1.0;
    begin += static_cast<std::size_t>(grid[0] * grid[1] * grid[2]);
  }
}

double busiest_of(std::span<const double> counts) {
  const double all = std::accumulate(counts.begin(), counts.end(), 0.0);
  if (all == 0.0) return 1.0;
  return *std::max_element(counts.begin(), counts.end()) * static_cast<double>(counts.size()) / all;
}

std::string advise_grid(double busiest, std::span<const RankGrid> grids,
                        std::span<const double> counts) {
  const std::size_t ranks = counts.size() / grids.size();
  const double all = std::accumulate(counts.begin(), counts.begin() + ranks, 0.0);
  if (busiest < kBusy || all < kFewest * static_cast<double>(ranks)) return {};
  double least = busiest;
  const RankGrid* best = nullptr;
  for (std::size_t g = 0; g < grids.size(); ++g) {
    const double there = busiest_of(counts.subspan(g * ranks, ranks));
    if (there >= least) continue;
    least = there;
    best = &grids[g];
  }
  const std::string share = fmt::format(
      "the busiest of {} ranks had {:.2f} times the mean of the particles: ", ranks, busiest);
  if (!best || least > kBetter * busiest)
    return share + "no grid of as many ranks shares them better; fewer ranks may be as fast";
  return share + fmt::format(
                     "\"processors {} {} {}\" before the box is made would share them with "
                     "{:.2f}, as they are at the end",
                     (*best)[0], (*best)[1], (*best)[2], least);
}

}  // namespace dem
