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

BlockLoads::BlockLoads(Fluid& fluid, const std::vector<CellBox>& blocks)
    : fluid_(fluid), cells_(blocks.size()), arrivals_(blocks.size()) {
  const Lattice& lattice = fluid.lattice();
  const Cell3& begin = fluid.cells().begin;
  for (std::size_t b = 0; b < blocks.size(); ++b) {
    for (int q = 1; q < lattice.Q; ++q)
      arrivals_[b].push_back({Vec3(lattice.c[q][0], lattice.c[q][1], lattice.c[q][2]), {}, {}, {}});
    each_cell(blocks[b], fluid.cells(), [&](const Cell3& cell) {
      // where blocks overlap, a cell is of the first
      const auto owner = std::find_if(blocks.begin(), blocks.end(),
                                      [&](const CellBox& box) { return box.holds(cell); });
      if (owner != blocks.begin() + static_cast<std::ptrdiff_t>(b)) return;
      ++cells_[b];
      const int x = cell[0] - begin[0], y = cell[1] - begin[1], z = cell[2] - begin[2];
      for (int q = 1; q < lattice.Q; ++q) {
        const auto from = origin(fluid.domain(), cell, lattice.c[q]);
        if (!from || std::any_of(blocks.begin(), blocks.end(),
                                 [&](const CellBox& box) { return box.holds(*from); }))
          continue;
        Arrivals& arrivals = arrivals_[b][q - 1];
        arrivals.in_even.push_back(fluid.arriving_in(false, q, x, y, z));
        arrivals.in_odd.push_back(fluid.arriving_in(true, q, x, y, z));
        Vec3 arm = Vec3(cell[0] + 0.5, cell[1] + 0.5, cell[2] + 0.5) - 0.5 * arrivals.c;
        arm -= blocks[b].centre();
        if (lattice.D == 2) arm[2] = 0.0;
        arrivals.arms.push_back(arm);
      }
    });
  }
}

std::vector<BodyLoad> BlockLoads::loads() const {
  std::vector<BodyLoad> all(arrivals_.size());
  for (std::size_t b = 0; b < all.size(); ++b)
    for (const Arrivals& arrivals : arrivals_[b]) {
      const auto& places = fluid_.odd() ? arrivals.in_odd : arrivals.in_even;
      double sum = 0.0;
      Vec3 moment = Vec3::Zero();
      for (std::size_t i = 0; i < places.size(); ++i) {
        const double f = places[i];
        sum += f;
        moment += f * arrivals.arms[i];
      }
      all[b].force += 2.0 * sum * arrivals.c;
      all[b].torque += 2.0 * moment.cross(arrivals.c);
    }
  return all;
}

}  // namespace lbm
