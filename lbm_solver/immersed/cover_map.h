// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "lbm_solver/base/simd.h"
#include "lbm_solver/immersed/footprint.h"
#include "lbm_solver/immersed/weight.h"

namespace lbm {

/// Covered cells, as one record for every SIMD block of a row that holds any. A block without a
/// record is pure fluid and is swept without asking further.
class CoverMap {
 public:
  using Lanes = std::array<double, kPackWidth>;

  /// What the collision of one block needs, and the force it leaves behind. The sweep reads and
  /// writes nothing else of the map.
  struct alignas(64) Block {
    Lanes weight;  ///< B, or ε where the kernel knows τ
    Lanes layer;   ///< 1 where Σ ε < 1, 0 below the surface, -1 in the core of a solid
    Lanes us, vs;  ///< solid velocity, ε-weighted mean
    Lanes fx, fy;  ///< force on the solids of the cell
  };

  /// @param weight  B of a cell; the plain fraction where the kernel makes B of it
  CoverMap(const Domain& domain, const ImmersedWeight& weight);

  /// Places the discs where they are now. A disc that has not moved keeps its fractions; where
  /// nothing has moved or changed its velocity, nothing is done.
  void update(std::span<const Disc> discs);

  /// Cells [x0, x1) × [y0, y1) are a wall at rest from the next update on: bounce-back in every
  /// cell.
  void add_wall(int x0, int y0, int x1, int y1);

  /// Record of block b of row y, or null.
  Block* block(int y, int b) {
    const std::int32_t record = entry(y, b).record;
    return record < 0 ? nullptr : &blocks_[record];
  }
  const Block* block(int y, int b) const { return const_cast<CoverMap*>(this)->block(y, b); }
  int blocks_per_row() const { return blocks_per_row_; }
  /// First block of row y from b on that has a record; blocks_per_row() where none has.
  int next_covered(int y, int b) const {
    const Entry* row = &entry(y, 0);
    while (b < blocks_per_row_ && row[b].record < 0) ++b;
    return b;
  }

  /// Load of each disc from the forces of the last sweep. Where solids share a cell, each takes the
  /// part of its fraction. Sums run over each disc's own cells in a fixed order, so a load depends
  /// neither on threads nor on the order of the discs.
  std::vector<DiscLoad> loads() const;

  /// Σ ε of a cell, at most 1.
  double solid_fraction(int x, int y) const;
  std::size_t covered_blocks() const { return blocks_.size(); }
  std::size_t bytes() const;

 private:
  /// A block of the lattice in the map.
  struct Entry {
    std::int32_t record = -1;  ///< in blocks_; -1: pure fluid
    std::int32_t share = -1;   ///< in shares_; -1: one solid alone
  };
  /// How the solids in a block with more than one share its cells.
  struct alignas(64) Share {
    Lanes eps;                ///< Σ ε
    std::int32_t record = 0;  ///< its block
  };
  struct Wall {
    int x0, y0, x1, y1;
  };

  const Entry& entry(int y, int b) const {
    return index_[static_cast<std::size_t>(y) * blocks_per_row_ + b];
  }
  void place_blocks();
  void count(int y, int first_block, int blocks);
  void write(const Disc& disc, const Footprint& footprint);
  void begin_shared();
  void share(const Disc& disc, const Footprint& footprint);
  void finish_shared();
  void write(const Wall& wall);

  Domain domain_;
  ImmersedWeight weight_;
  int blocks_per_row_;
  std::vector<Entry> index_;  // [row][block]
  std::vector<Block> blocks_;
  std::vector<Share> shares_;
  std::vector<Wall> walls_;
  bool walls_changed_ = false;
  std::vector<Disc> discs_;
  std::vector<Footprint> footprints_;  // [disc]
};

}  // namespace lbm
