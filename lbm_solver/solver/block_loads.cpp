// SPDX-License-Identifier: GPL-2.0-or-later
#include "lbm_solver/solver/block_loads.h"

#include <algorithm>
#include <optional>

namespace lbm {
namespace {

/// The cell at the other end of a link; nothing beyond a wall of the box.
std::optional<Cell3> origin(const Domain& domain, const Cell3& cell, const int* c) {
  Cell3 from = cell;
  for (int a = 0; a < 3; ++a) {
    const int n = domain.cells()[a];
    from[a] -= c[a];
    if (from[a] >= 0 && from[a] < n) continue;
    if (domain.sides()[a] == Side::Wall) return std::nullopt;
    from[a] = (from[a] + n) % n;
  }
  return from;
}

/// Calls f(cell) for each cell of the box that a rank sweeps.
template <class F>
void each_cell(const CellBox& box, const Block& mine, F&& f) {
  for (int z = box.from[2]; z < box.to[2]; ++z)
    for (int y = box.from[1]; y < box.to[1]; ++y)
      for (int x = box.from[0]; x < box.to[0]; ++x)
        if (mine.holds({x, y, z})) f(Cell3{x, y, z});
}

}  // namespace

BlockLoads::BlockLoads(const Fluid& fluid, const std::vector<CellBox>& blocks)
    : arrivals_(blocks.size()) {
  const Lattice& lattice = fluid.lattice();
  const Block& mine = fluid.cells();
  for (std::size_t b = 0; b < blocks.size(); ++b)
    each_cell(blocks[b], mine, [&](const Cell3& cell) {
      // where blocks overlap, a cell is of the first
      const auto owner = std::find_if(blocks.begin(), blocks.end(),
                                      [&](const CellBox& box) { return box.holds(cell); });
      if (owner != blocks.begin() + static_cast<std::ptrdiff_t>(b)) return;
      for (int q = 1; q < lattice.Q; ++q) {
        const int* c = lattice.c[q];
        const auto from = origin(fluid.domain(), cell, c);
        if (!from || std::any_of(blocks.begin(), blocks.end(),
                                 [&](const CellBox& box) { return box.holds(*from); }))
          continue;
        Arrival arrival{cell, q, {}};
        for (int a = 0; a < 3; ++a) {
          arrival.cell[a] -= mine.begin[a];
          arrival.arm[a] = cell[a] + 0.5 - 0.5 * c[a];
        }
        arrival.arm -= blocks[b].centre();
        if (lattice.D == 2) arrival.arm[2] = 0.0;
        arrivals_[b].push_back(arrival);
      }
    });
}

std::vector<BodyLoad> BlockLoads::loads(const Fluid& fluid) const {
  std::vector<BodyLoad> all(arrivals_.size());
  for (std::size_t b = 0; b < all.size(); ++b)
    for (const auto& [cell, q, arm] : arrivals_[b]) {
      const int* c = fluid.lattice().c[q];
      const double twice = 2.0 * fluid.arriving(q, cell[0], cell[1], cell[2]);
      all[b].add(twice * Vec3(c[0], c[1], c[2]), arm);
    }
  return all;
}

}  // namespace lbm
