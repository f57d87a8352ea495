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
/// load is against the reference). Where blocks touch, nothing passes between them.
class BlockLoads {
 public:
  BlockLoads(const Fluid& fluid, const std::vector<CellBox>& blocks);

  /// On each block by the populations that arrive in the coming step: this rank's cells' part,
  /// lattice units.
  std::vector<BodyLoad> loads(const Fluid& fluid) const;

 private:
  struct Arrival {
    Cell3 cell;  ///< of this rank
    int q;
    Vec3 arm;  ///< to the middle of the link
  };
  std::vector<std::vector<Arrival>> arrivals_;  // [block]
};

}  // namespace lbm
