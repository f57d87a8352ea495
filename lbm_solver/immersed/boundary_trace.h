// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <vector>

#include "lbm_solver/base/units.h"

namespace lbm {

/// The boundary cells of a disc as paper B finds them (§2.3.1, its second step corrected): by
/// walking around it cell by cell. Only these need a solid fraction; what they enclose is whole.
/// Covered cells are found by rows of blocks instead (`footprint.h`), which is faster and serves
/// SIMD; this walk is here to be compared with.
struct BoundaryTrace {
  struct Cell {
    int x, y;
    auto operator<=>(const Cell&) const = default;
  };
  std::vector<Cell> solid;  ///< inside, with an outside cell among the eight neighbours
  std::vector<Cell> fluid;  ///< outside, with an inside cell among the eight neighbours
};

/// @param centre, radius  in cells; a cell is inside where its centre is; radius at least 1.5
BoundaryTrace trace_boundary(const Vec3& centre, double radius);

}  // namespace lbm
