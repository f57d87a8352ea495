// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <vector>

#include "lbm_solver/immersed/body.h"
#include "lbm_solver/immersed/geometry.h"
#include "lbm_solver/solver/fluid.h"

namespace lbm {

/// Loads on walls inside the box by momentum balance: a wall's cell sends back all that arrives, so
/// what arrives along c_q leaves it with twice its momentum,
///   F = Σ 2 c_q (f_q - w_q)
/// over the links from cells outside of walls, and T = Σ r × 2 c_q (f_q - w_q) with r from the
/// block's centre to the middle of the link. The rest density presses on no side (the pressure of a
/// load is against the reference). Where blocks touch, nothing passes between them. The places of
/// the populations are found once: the loads of a step cost a few nanoseconds a link.
class BlockLoads {
 public:
  /// @param fluid  outlives this, and stays where it is
  BlockLoads(Fluid& fluid, const std::vector<CellBox>& blocks);

  /// On each block by the populations that arrive in the coming step: this rank's cells' part,
  /// lattice units.
  std::vector<BodyLoad> loads() const;

  /// Cells of each block that this rank sweeps; one that blocks share is of the first.
  const std::vector<int>& cells() const { return cells_; }

 private:
  /// What arrives along one direction at one block.
  struct Arrivals {
    Vec3 c;
    std::vector<Population> in_even, in_odd;  ///< of a step: where it lies
    std::vector<Vec3> arms;                   ///< to the middle of each link
  };
  const Fluid& fluid_;
  std::vector<int> cells_;
  std::vector<std::vector<Arrivals>> arrivals_;  // [block][direction - 1]
};

}  // namespace lbm
