// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <array>
#include <vector>

#include "lbm_solver/solver/fluid.h"

namespace lbm {

/// Loads of the fluid on the sides of the box by momentum balance: a half-way wall takes what
/// leaves along -c_q and gives back what arrives along c_q,
///   F = Σ -c_q (f_-q* + f_q - 2 w_q)
/// over the links through the side. At rest both are equal; a moving wall's (VelocityPatch)
/// difference is known. Links through pressures and outflows are left out: there is no wall. A
/// diagonal link through a corner of two walls gives each side the part along its normal. The rest
/// density presses on no side.
class SideLoads {
 public:
  SideLoads(const Fluid& fluid, SideName side);

  /// In the last step on this rank's part of the side, lattice units.
  Vec3 force(const Fluid& fluid) const;

 private:
  struct Wall {
    Cell3 cell;  // of this rank
    int q;
    Vec3 weight;  // -c_q, or what of it belongs to the side
    const VelocityPatch* moving = nullptr;
    std::size_t link = 0;  // of it
  };
  std::vector<Wall> walls_;
};

}  // namespace lbm
