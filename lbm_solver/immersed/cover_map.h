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

/// One number a lane of a SIMD block.
struct alignas(64) Lanes : std::array<double, kPackWidth> {};

/// What the collision of one block of covered cells needs, and the force it leaves behind. The
/// sweep reads and writes nothing else of the map.
template <int D>
struct CoverBlock {
  Lanes weight;    ///< B, or ε where the kernel knows τ
  Lanes layer;     ///< 1 where Σ ε < 1, 0 below the surface, -1 in the core of a solid
  Lanes u[D];      ///< solid velocity, ε-weighted mean
  Lanes force[D];  ///< on the solids of the cell
};

/// Covered cells of a rank, as one record for every SIMD block of a row that holds any. A block
/// without a record is pure fluid and is swept without asking further.
class CoverMap {
 public:
  /// @param weight  B of a cell; the plain fraction where the kernel makes B of it
  CoverMap(const Domain& domain, const Block& cells, const ImmersedWeight& weight);
  CoverMap(const Domain& domain, const ImmersedWeight& weight)
      : CoverMap(domain, Block::whole(domain), weight) {}

  /// Places the bodies where they are now. One that has not moved keeps its fractions; where
  /// nothing has moved or changed its velocity, nothing is done.
  void update(std::span<const Body> bodies);

  /// Cells [from, to) of the box are a wall at rest from the next update on: bounce-back in every
  /// cell.
  void add_wall(const Cell3& from, const Cell3& to);

  /// Record of block b of row (y, z), or null.
  template <int D>
  CoverBlock<D>* block(int y, int z, int b) {
    const std::int32_t record = entry(y, z, b).record;
    return record < 0 ? nullptr : reinterpret_cast<CoverBlock<D>*>(lanes(record));
  }
  template <int D>
  const CoverBlock<D>* block(int y, int z, int b) const {
    return const_cast<CoverMap*>(this)->block<D>(y, z, b);
  }
  int blocks_per_row() const { return blocks_per_row_; }
  /// First block of row (y, z) from b on that has a record; blocks_per_row() where none has.
  int next_covered(int y, int z, int b) const {
    const Entry* row = &entry(y, z, 0);
    while (b < blocks_per_row_ && row[b].record < 0) ++b;
    return b;
  }

  /// Load of each body from the forces of the last sweep. Where solids share a cell, each takes the
  /// part of its fraction. Sums run over each body's own cells in a fixed order, so a load depends
  /// neither on threads nor on the order of the bodies.
  std::vector<BodyLoad> loads() const;

  /// Σ ε of a cell of the rank, at most 1.
  double solid_fraction(int x, int y, int z = 0) const;
  std::size_t covered_blocks() const { return static_cast<std::size_t>(records_); }
  std::size_t bytes() const;

 private:
  /// A block of the lattice in the map.
  struct Entry {
    std::int32_t record = -1;  ///< -1: pure fluid
    std::int32_t share = -1;   ///< in shares_; -1: one solid alone
  };
  /// How the solids in a block with more than one share its cells.
  struct Share {
    Lanes eps;                ///< Σ ε
    std::int32_t record = 0;  ///< its block
  };
  struct Wall {
    Cell3 from, to;  ///< of the rank's cells
  };

  const Entry& entry(int y, int z, int b) const {
    return index_[(static_cast<std::size_t>(z) * cells_.size[1] + y) * blocks_per_row_ + b];
  }
  /// A record: weight, layer, velocity and force, one after another (CoverBlock).
  Lanes* lanes(std::int32_t record) { return &lanes_[static_cast<std::size_t>(record) * size_]; }
  const Lanes* lanes(std::int32_t record) const {
    return &lanes_[static_cast<std::size_t>(record) * size_];
  }
  Lanes* velocity(std::int32_t record) { return lanes(record) + 2; }
  const Lanes* force(std::int32_t record) const { return lanes(record) + 2 + d_; }

  template <class F>
  static void each_row(const Wall& wall, F&& f);
  void place_blocks();
  void count(int y, int z, int first_block, int blocks);
  template <int D>
  void write(const Body& body, const Footprint& footprint);
  void begin_shared();
  template <int D>
  void share(const Body& body, const Footprint& footprint);
  void finish_shared();
  void write(const Wall& wall);
  template <int D>
  BodyLoad load_of(const Footprint& footprint) const;

  Domain domain_;
  Block cells_;
  int d_, size_;  // dimension, lanes of a record
  ImmersedWeight weight_;
  int blocks_per_row_;
  std::vector<Entry> index_;  // [layer][row][block]
  std::vector<Lanes> lanes_;  // [record][size_]
  std::int32_t records_ = 0;
  std::vector<Share> shares_;
  std::vector<Wall> walls_;
  bool walls_changed_ = false;
  std::vector<Body> bodies_;
  std::vector<Footprint> footprints_;  // [body]
};

}  // namespace lbm
