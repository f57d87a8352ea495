// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <vector>

#include "lbm_solver/base/held_bytes.h"
#include "lbm_solver/field/domain.h"
#include "lbm_solver/immersed/body.h"
#include "lbm_solver/immersed/cover_block.h"

namespace lbm {

/// Cells whose centre lies deeper than this below the surface are the core of a solid, in cells:
/// the surface cells (0.71; 0.87 in three dimensions) and the layer of whole cells that bounds the
/// flow outside are above it.
inline constexpr double kCoreDepth = 2.0;

/// Places at which bodies are mapped lie on a grid of this spacing, in cells: one that creeps
/// keeps its fractions for many steps. That the place depends on nothing before is what keeps
/// restarts exact, and the same on every rank. It moves a body by 0.004 cells at most.
inline constexpr double kSnap = 1.0 / 128.0;

/// The cells of a rank that one body covers, as spans of SIMD blocks, its periodic images included.
class Footprint {
 public:
  /// Blocks of one row. Lanes that the body does not cover have fraction 0.
  struct Span {
    int y, z, block;  ///< row, first block; of the rank's cells
    int blocks;
    int first;                 ///< index of the first block in blocks()
    int core_begin, core_end;  ///< lanes of the core, counted from the first
    /// Centre of the first lane's cell minus that of the covering image.
    double arm_x, arm_y, arm_z;

    int x() const { return block * kPackWidth; }       ///< cell of the first lane
    int count() const { return blocks * kPackWidth; }  ///< lanes
    bool same_blocks(const Span& s) const {
      return y == s.y && z == s.z && block == s.block && blocks == s.blocks;
    }
  };
  enum class Change { None, Fractions, Spans };

  /// Looks what a body's place changes; spans and blocks stay as they are until write().
  Change look(const Body& body, const Domain& domain, const Block& cells);
  /// Spans and blocks of the place that was looked at. Where spans do not change, blocks stay where
  /// they are, linked as they are.
  void write();

  /// Both at once. @return whether anything changed
  bool update(const Body& body, const Domain& domain) {
    const bool changed = look(body, domain, Block::whole(domain)) != Change::None;
    if (changed) write();
    return changed;
  }

  const std::vector<Span>& spans() const { return spans_; }
  std::vector<CoverBlock>& blocks() { return blocks_; }
  const std::vector<CoverBlock>& blocks() const { return blocks_; }
  /// Of memory that its lists hold.
  std::size_t bytes() const { return held(spans_) + held(next_) + held(blocks_); }

 private:
  void find_image(const Vec3& centre, const Block& cells);
  void find_outside(const Vec3& centre, const Block& cells);
  Pack fractions(const Span& span, int k) const;
  void write(const Span& span);

  Vec3 centre_;
  double radius_ = -1.0;
  bool hollow_ = false, sphere_ = false;
  int row_end_ = 0;                 ///< cells of a row of the rank
  std::vector<Span> spans_, next_;  ///< as they are; as they will be
  std::vector<CoverBlock> blocks_;
};

}  // namespace lbm
