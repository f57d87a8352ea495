// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <vector>

#include "lbm_solver/base/simd.h"
#include "lbm_solver/field/populations.h"
#include "lbm_solver/immersed/disc.h"

namespace lbm {

/// Extent of the lattice and what its sides do; where images of a disc can be.
struct Domain {
  int nx = 0, ny = 0;
  Side x = Side::Wall, y = Side::Wall;
};

/// Cells whose centre lies deeper than this below the surface are the core of a solid, in cells:
/// the surface cells (0.71) and the layer of whole cells that bounds the flow outside are above it.
inline constexpr double kCoreDepth = 2.0;

/// Places at which discs are mapped lie on a grid of this spacing, in cells: a disc that creeps
/// keeps its fractions for many steps. That the place depends on nothing before is what keeps
/// restarts exact. It moves a disc by 0.004 cells at most.
inline constexpr double kSnap = 1.0 / 128.0;

/// The cells that one disc covers, as spans of SIMD blocks with a solid fraction a lane, its
/// periodic images included.
class Footprint {
 public:
  /// Whole SIMD blocks of one row. Lanes that the disc does not cover have fraction 0.
  struct Span {
    int y, block;  ///< row, first block
    int blocks;
    int eps;                   ///< index of the fraction of the first lane in `fractions`
    int core_begin, core_end;  ///< lanes of the core, counted from the first
    double arm_x, arm_y;       ///< centre of the first lane's cell minus that of the covering image

    int x() const { return block * kPackWidth; }       ///< cell of the first lane
    int count() const { return blocks * kPackWidth; }  ///< lanes
  };

  /// Computes the spans anew unless the disc is where it was (to kSnap).
  /// @return whether anything changed
  bool update(const Disc& disc, const Domain& domain);

  const std::vector<Span>& spans() const { return spans_; }
  const std::vector<double>& fractions() const { return fractions_; }

 private:
  void add_image(const Vec2& centre, double radius, const Domain& domain);
  void add_outside(const Vec2& centre, double radius, const Domain& domain);
  Vec2 centre_{0.0, 0.0};
  double radius_ = -1.0;
  bool hollow_ = false;
  std::vector<Span> spans_;
  std::vector<double> fractions_;
};

}  // namespace lbm
