// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <array>
#include <cmath>

#include "lbm_solver/base/vec3.h"

namespace lbm {

/// What a pair of opposite sides of the box does to populations that leave through it.
enum class Side { Periodic, Wall };

/// The box in cells and what its sides do. In two dimensions there is one layer of cells in z.
struct Domain {
  int nx = 0, ny = 0;
  Side x = Side::Wall, y = Side::Wall;
  int nz = 1;
  Side z = Side::Periodic;

  int dimension() const { return nz > 1 ? 3 : 2; }
  Cell3 cells() const { return {nx, ny, nz}; }
  std::array<Side, 3> sides() const { return {x, y, z}; }

  /// Shortest vector among those that differ by periodic lengths.
  Vec3 nearest_image(Vec3 v) const {
    for (int a = 0; a < 3; ++a)
      if (sides()[a] == Side::Periodic) v[a] -= cells()[a] * std::round(v[a] / cells()[a]);
    return v;
  }
};

/// What lies beyond one face of the cells that a rank sweeps: their own other side, a wall, or
/// the cells of another rank.
enum class Face { Periodic, Wall, Neighbour };
using Faces = std::array<std::array<Face, 2>, 3>;  // [axis][low, high]

/// The cells that a rank sweeps: [begin, begin + size) of the box.
struct Block {
  Cell3 begin{0, 0, 0}, size{0, 0, 1};
  Faces faces{};

  /// The whole box, of a rank alone.
  static Block whole(const Domain& domain) {
    Block block{{0, 0, 0}, domain.cells(), {}};
    for (int a = 0; a < 3; ++a)
      block.faces[a].fill(domain.sides()[a] == Side::Wall ? Face::Wall : Face::Periodic);
    return block;
  }
  bool holds(const Cell3& cell) const {
    for (int a = 0; a < 3; ++a)
      if (cell[a] < begin[a] || cell[a] >= begin[a] + size[a]) return false;
    return true;
  }
};

}  // namespace lbm
