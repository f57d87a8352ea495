// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include "lbm_solver/solver/block_loads.h"
#include "lbm_solver/solver/fluid.h"

namespace lbm {

/// What passes a plane between two layers of cells, lattice units. The volume is that of the
/// populations that cross it,
///   Σ f_q (c_q forward, in the layer beyond) - Σ f_q (c_q backward, in the layer before),
/// without those that come back from a side along the plane: the same through every plane of a
/// steady flow, whatever covers the cells. Before the first step none have crossed (what is there
/// lacks half of a body force, and would show a flow against it): it is then that of the initial
/// velocity, Σ (1-ε) ρ u_n. All else is the mean of both layers, whose cells count
/// by their part of fluid.
struct PlaneFlow {
  double volume = 0.0;    ///< flow, positive along the axis
  Vec3 momentum;          ///< Σ (1-ε) ρ u u_n
  double pressure = 0.0;  ///< Σ (1-ε) (ρ-1)
  double area = 0.0;      ///< Σ (1-ε)

  /// This rank's part. @param beyond  the layer of cells of the box on the plane's high side, one
  /// thick along the axis
  static PlaneFlow of(const Fluid& fluid, const CellBox& beyond, int axis);
};

}  // namespace lbm
