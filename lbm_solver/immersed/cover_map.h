// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "lbm_solver/base/pose.h"
#include "lbm_solver/immersed/footprint.h"
#include "lbm_solver/immersed/radius_shift.h"

namespace lbm {

struct Geometry;
class MovingShape;

/// Covered cells of a rank: where a sweep finds the blocks of the solids. A block of the lattice
/// that holds none is pure fluid and is swept without asking further.
class CoverMap {
 public:
  CoverMap(const Domain& domain, const Block& cells, const RadiusShift& shift = {});
  explicit CoverMap(const Domain& domain) : CoverMap(domain, Block::whole(domain)) {}
  CoverMap(const CoverMap&) = delete;  // blocks point at each other
  CoverMap& operator=(const CoverMap&) = delete;
  ~CoverMap();

  /// Places the bodies where they are now. One that has not moved costs nothing.
  void update(std::span<const Body> bodies);

  /// Cells [from, to) of the box are a wall at rest: bounce-back in every cell.
  void add_wall(const Cell3& from, const Cell3& to);
  /// A solid of any shape that stays where it is: cells that it covers whole are a wall, those at
  /// its surface collide as those of a body do. @throws std::invalid_argument  see fill()
  void add(const Geometry& geometry);
  /// A mesh that moves: cells that it covers whole are those of a body that moves. To be called
  /// before bodies are placed. @throws std::invalid_argument  see fill()
  void add(std::unique_ptr<MovingShape> shape);
  /// Where the meshes that move are in the coming step, in the order in which they were added.
  void move(std::span<const Pose> poses);

  int blocks_per_row() const { return blocks_per_row_; }
  /// For each SIMD block of row (y, z): what the first solid covers of it, with the others after
  /// it; null: fluid. The next row follows, after the last one kRowsEnd nulls.
  CoverBlock* const* row(int y, int z) const { return &index_[place(y, z, 0)]; }
  static constexpr int kRowsEnd = 4;
  /// First block of row (y, z) from b on that is covered; blocks_per_row() where none is.
  int next_covered(int y, int z, int b) const {
    CoverBlock* const* const blocks = row(y, z);
    while (b < blocks_per_row_ && !blocks[b]) ++b;
    return b;
  }

  const Motion& motion(const CoverBlock& block) const { return motions_[block.motion]; }

  /// Cells of a block that several solids share. Those of one clump count as their union: together
  /// they cover no more than a whole cell.
  template <int D>
  struct Shared {
    Pack cover;  ///< as of one solid
    Pack scale;  ///< 1 / Σ ε; 0 where nothing is
    Pack u[D];   ///< ε-weighted mean
  };
  template <int D>
  Shared<D> merge(const CoverBlock& first) const;
  /// Gives each solid of a block its part of the force on them, ε / Σ ε.
  template <int D>
  void split(CoverBlock& first, const Pack& scale, const Pack (&force)[D]) const;

  /// Load of each body from the forces of the last sweep. Sums run over each body's own cells in a
  /// fixed order, so a load depends neither on threads nor on the order of the bodies.
  std::vector<BodyLoad> loads() const;
  /// Likewise of the solids that were added, about their centres.
  std::vector<BodyLoad> fixed_loads() const;

  /// What covers a cell of the rank.
  struct Cell {
    double cover;  ///< solid fraction, at most 1, or kCore, or kWall
    Vec3 velocity;
  };
  Cell cell(int x, int y, int z = 0) const;
  /// Σ ε of a cell of the rank, at most 1.
  double solid_fraction(int x, int y, int z = 0) const;
  std::size_t covered_blocks() const;
  /// Of memory that it holds: what the bodies cover, how each is found, and the meshes that move.
  std::size_t bytes() const;

 private:
  std::size_t place(int y, int z, int b) const {
    return (static_cast<std::size_t>(z) * cells_.size[1] + y) * blocks_per_row_ + b;
  }
  void link(Footprint& footprint, std::int32_t motion);
  void unlink(Footprint& footprint);
  void unlink(std::size_t place, CoverBlock& block);
  static void insert(CoverBlock*& at, CoverBlock& block);
  Pack part_of_union(const CoverBlock& first, const CoverBlock& block) const;
  template <int D>
  static BodyLoad load_of(std::span<const CoverBlock> blocks);
  std::vector<CoverBlock> fill_blocks(const Geometry& geometry);
  struct Mover;

  Domain domain_;
  Block cells_;
  RadiusShift shift_;  // of bodies, not of walls
  int d_;
  int blocks_per_row_;
  std::vector<CoverBlock*> index_;                      // [layer][row][block], then kRowsEnd nulls
  std::vector<Motion> motions_;                         // at rest; of each mover; of each body
  std::vector<std::int32_t> carriers_;                  // [motion]; empty where there is no clump
  std::vector<Footprint> footprints_;                   // [body]
  std::vector<std::vector<CoverBlock>> walls_, fixed_;  // [wall]; [solid that was added]
  std::vector<Mover> movers_;                           // those among fixed_ that move
};

}  // namespace lbm
