// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <cstddef>
#include <functional>
#include <span>
#include <vector>

#include "lbm_solver/base/vec3.h"

namespace lbm {

/// Cells [begin, begin + size) of the box.
struct CellRange {
  Cell3 begin{0, 0, 0}, size{0, 0, 0};

  std::size_t count() const {
    return static_cast<std::size_t>(size[0]) * static_cast<std::size_t>(size[1]) *
           static_cast<std::size_t>(size[2]);
  }
  bool holds(const CellRange& other) const;
  /// Calls f(cell, number) for each, counted as the numbers of a piece are: x fastest.
  template <class F>
  void each(F&& f) const {
    std::size_t number = 0;
    for (int z = begin[2]; z < begin[2] + size[2]; ++z)
      for (int y = begin[1]; y < begin[1] + size[1]; ++y)
        for (int x = begin[0]; x < begin[0] + size[0]; ++x) f(Cell3{x, y, z}, number++);
  }
};

/// A range as pieces of whole rows of it, [z][y], in the order of memory: each takes no more than
/// some megabytes, but for a row that is longer.
std::vector<CellRange> pieces_of(const CellRange& range, std::size_t bytes_a_cell);

/// Numbers of every cell of the box, of which a rank can read those of some cells, a piece at a
/// time: so nobody needs room for all of them. They are read from the object (or file) that they
/// come from: before it changes.
struct CellValues {
  Cell3 box{0, 0, 0};
  int components = 1;
  bool single = false;  ///< precise to single precision, and stored so
  CellRange here;       ///< cells that `read` may be asked for
  /// Fills [z][y][x][components] of a part of `here`.
  std::function<void(const CellRange&, std::span<double>)> read;

  /// The same numbers in memory, whatever becomes of their source.
  CellValues kept() const;
};
/// Whether both have the same cells and numbers.
bool operator==(const CellValues& a, const CellValues& b);

}  // namespace lbm
