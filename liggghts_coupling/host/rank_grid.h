// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <array>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace dem {

using RankGrid = std::array<int, 3>;

/// Every grid of as many ranks, in two dimensions with one along z.
std::vector<RankGrid> grids_of(int ranks, int dimension);

/// Counts a place to the ranks that would own it, one of each grid: LIGGGHTS divides the box into
/// equal parts along each axis.
/// @param at      place in the box, 0 … 1 along each axis
/// @param counts  [grid][rank], all grids of the same ranks
void count_place(std::span<const RankGrid> grids, const std::array<double, 3>& at,
                 std::vector<double>& counts);

/// The most that a rank of a grid has over the mean. @param counts  of `grid` among those counted
double busiest_of(std::span<const double> counts);

/// What is said of ranks that share the particles badly; empty where they do not, or have few.
/// @param busiest  the most that a rank had over the mean, in the mean of the run
/// @param counts   [grid][rank] where the particles are now
std::string advise_grid(double busiest, std::span<const RankGrid> grids,
                        std::span<const double> counts);

}  // namespace dem
