// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <vector>

#include "lbm_solver/base/simd.h"
#include "lbm_solver/field/domain.h"
#include "lbm_solver/immersed/body.h"

namespace lbm {

/// Cells whose centre lies deeper than this below the surface are the core of a solid, in cells:
/// the surface cells (0.71; 0.87 in three dimensions) and the layer of whole cells that bounds the
/// flow outside are above it.
inline constexpr double kCoreDepth = 2.0;

/// Places at which bodies are mapped lie on a grid of this spacing, in cells: one that creeps
/// keeps its fractions for many steps. That the place depends on nothing before is what keeps
/// restarts exact, and the same on every rank. It moves a body by 0.004 cells at most.
inline constexpr double kSnap = 1.0 / 128.0;

/// The cells of a rank that one body covers, as spans of SIMD blocks with a solid fraction a lane,
/// its periodic images included.
class Footprint {
 public:
  /// Whole SIMD blocks of one row. Lanes that the body does not cover have fraction 0.
  struct Span {
    int y, z, block;  ///< row, first block; of the rank's cells
    int blocks;
    int eps;                   ///< index of the fraction of the first lane in `fractions`
    int core_begin, core_end;  ///< lanes of the core, counted from the first
    /// Centre of the first lane's cell minus that of the covering image.
    double arm_x, arm_y, arm_z;

    int x() const { return block * kPackWidth; }       ///< cell of the first lane
    int count() const { return blocks * kPackWidth; }  ///< lanes
  };

  /// Computes the spans anew unless the body is where it was (to kSnap).
  /// @return whether anything changed
  bool update(const Body& body, const Domain& domain, const Block& cells);
  bool update(const Body& body, const Domain& domain) {
    return update(body, domain, Block::whole(domain));
  }

  const std::vector<Span>& spans() const { return spans_; }
  const std::vector<double>& fractions() const { return fractions_; }

 private:
  void add_image(const Vec3& centre, double radius, const Block& cells, bool sphere);
  void add_row(const Span& row, int count, double across2, double radius, bool sphere);
  void add_outside(const Vec3& centre, double radius, const Block& cells, bool sphere);
  Vec3 centre_;
  double radius_ = -1.0;
  bool hollow_ = false;
  std::vector<Span> spans_;
  std::vector<double> fractions_;
};

}  // namespace lbm
