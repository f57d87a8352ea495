// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "lbm_solver/base/simd.h"
#include "lbm_solver/immersed/footprint.h"

namespace lbm {

/// Covered cells, as one record for every SIMD block of a row that holds any. A block without a
/// record is pure fluid and is swept without asking further.
class CoverMap {
 public:
  using Lanes = std::array<double, kPackWidth>;

  /// What the collision of one block needs, and the force it leaves behind. The sweep reads and
  /// writes nothing else of the map.
  struct alignas(64) Block {
    Lanes weight;  ///< B
    Lanes layer;   ///< 1 where Σ ε < 1, 0 below the surface, -1 in the core of a solid
    Lanes us, vs;  ///< solid velocity, ε-weighted mean
    Lanes fx, fy;  ///< force on the solids of the cell
  };
  /// How the solids in a cell share it; beside the sweep's records, same numbers.
  struct alignas(64) Share {
    Lanes eps;      ///< Σ ε over the solids in the cell
    Lanes per_eps;  ///< 1 / Σ ε, 0 where nothing covers the cell
  };

  CoverMap(const Domain& domain, double tau);

  /// Places the discs where they are now. A disc that has not moved keeps its fractions; velocities
  /// are always taken anew.
  void update(std::span<const Disc> discs);

  /// Cells [x0, x1) × [y0, y1) are a wall at rest from the next update on: bounce-back in every
  /// cell.
  void add_wall(int x0, int y0, int x1, int y1);

  /// Record of block b of row y, or null.
  Block* block(int y, int b) {
    const std::int32_t index = index_[static_cast<std::size_t>(y) * blocks_per_row_ + b];
    return index < 0 ? nullptr : &blocks_[index];
  }
  const Block* block(int y, int b) const { return const_cast<CoverMap*>(this)->block(y, b); }
  /// Record of a block that is known to have one.
  std::int32_t record(int y, int b) const {
    return index_[static_cast<std::size_t>(y) * blocks_per_row_ + b];
  }
  int blocks_per_row() const { return blocks_per_row_; }
  /// First block of row y from b on that has a record; blocks_per_row() where none has.
  int next_covered(int y, int b) const {
    const std::int32_t* row = &index_[static_cast<std::size_t>(y) * blocks_per_row_];
    while (b < blocks_per_row_ && row[b] < 0) ++b;
    return b;
  }

  /// Load of each disc from the forces of the last sweep. Where solids share a cell, each takes the
  /// part of its fraction. Sums run over each disc's own cells in a fixed order, so a load depends
  /// neither on threads nor on the order of the discs.
  std::vector<DiscLoad> loads() const;

  double solid_fraction(int x, int y) const;
  std::size_t covered_blocks() const { return blocks_.size(); }
  std::size_t bytes() const;

 private:
  struct Wall {
    int x0, y0, x1, y1;
  };
  void place_blocks();
  void mark(int y, int x0, int x1);
  void add(const Wall& wall);
  void add(const Disc& disc, const Footprint& footprint);
  void finish();

  Domain domain_;
  double tau_;
  int blocks_per_row_;
  std::vector<std::int32_t> index_;  // [row][block], -1: pure fluid
  std::vector<Block> blocks_;
  std::vector<Share> shares_;
  std::vector<Wall> walls_;
  bool walls_changed_ = false;
  std::vector<Disc> discs_;
  std::vector<Footprint> footprints_;  // [disc]
};

}  // namespace lbm
