// SPDX-License-Identifier: GPL-2.0-or-later
#include "lbm_solver/solver/plane_flow.h"

#include <algorithm>

namespace lbm {
namespace {

/// Calls f(x, y, z) for each cell of a layer that a rank has, in its own count.
template <class F>
void each_own_cell(const Fluid& fluid, const CellBox& layer, F&& f) {
  const Block& mine = fluid.cells();
  Cell3 from, to;
  for (int k = 0; k < 3; ++k) {
    from[k] = std::max(layer.from[k] - mine.begin[k], 0);
    to[k] = std::min(layer.to[k] - mine.begin[k], mine.size[k]);
  }
  for (int z = from[2]; z < to[2]; ++z)
    for (int y = from[1]; y < to[1]; ++y)
      for (int x = from[0]; x < to[0]; ++x) f(x, y, z);
}

/// The layer before, through a periodic side the last one.
CellBox before(const CellBox& layer, const Domain& domain, int axis) {
  CellBox other = layer;
  const int n = domain.cells()[axis];
  other.from[axis] = (layer.from[axis] + n - 1) % n;
  other.to[axis] = other.from[axis] + 1;
  return other;
}

/// Whether what arrives along q has come through a side of the box that the plane meets.
bool from_a_side(const Fluid& fluid, const Cell3& cell, int q, int axis) {
  for (int k = 0; k < fluid.lattice().D; ++k) {
    const int from = cell[k] + fluid.cells().begin[k] - fluid.lattice().c[q][k];
    const bool outside = from < 0 || from >= fluid.domain().cells()[k];
    if (k != axis && outside && fluid.domain().sides()[k] == Side::Wall) return true;
  }
  return false;
}

}  // namespace

PlaneFlow PlaneFlow::of(const Fluid& fluid, const CellBox& beyond, int axis) {
  PlaneFlow sum;
  const Lattice& lattice = fluid.lattice();
  const bool crossed = fluid.steps() > 0;
  for (const int way : {1, -1}) {
    const CellBox layer = way > 0 ? beyond : before(beyond, fluid.domain(), axis);
    each_own_cell(fluid, layer, [&](int x, int y, int z) {
      for (int q = 1; q < lattice.Q && crossed; ++q)
        if (lattice.c[q][axis] == way && !from_a_side(fluid, {x, y, z}, q, axis))
          sum.volume += way * fluid.arriving(q, x, y, z);
      const double open =
          fluid.has_solids() ? 1.0 - std::min(1.0, fluid.solid_fraction(x, y, z)) : 1.0;
      if (open <= 0.0) return;
      const Fluid::Cell cell = fluid.cell(x, y, z);
      if (!crossed) sum.volume += 0.5 * open * cell.rho * cell.u[axis];
      sum.momentum += 0.5 * open * cell.rho * cell.u[axis] * cell.u;
      sum.pressure += 0.5 * open * (cell.rho - 1.0);
      sum.area += 0.5 * open;
    });
  }
  return sum;
}

}  // namespace lbm
