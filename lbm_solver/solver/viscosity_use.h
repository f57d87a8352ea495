// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <span>

#include "lbm_solver/collision/parameters.h"
#include "lbm_solver/solver/fluid.h"

namespace lbm {

/// What the flow makes of a viscosity that depends on the shear rate, over all fluid of the box: a
/// cell that solids cover in part counts with the part of it that is fluid.
struct ViscosityUse {
  /// Shares of the fluid whose viscosity is the law's bound at rest, and that at high shear rates,
  /// within a thousandth. An eddy viscosity on top does not count.
  double at_rest_bound = 0.0, at_shear_bound = 0.0;
  double largest_shear = 0.0;   ///< a step; of cells of which at least half is fluid
  double mean_viscosity = 0.0;  ///< lattice units
};

/// Of the present state. Collective.
/// @param parameters  of the kernel, with a table of the viscosity
ViscosityUse viscosity_use(const Fluid& fluid, const CollisionParameters& parameters);

/// Kinematic viscosity with which the cells of a row collide, an eddy viscosity with it, lattice
/// units; not a number where a solid covers a cell whole.
/// @param nu  [nx], overwritten
void row_viscosity(const Fluid& fluid, const CollisionParameters& parameters, int y, int z,
                   std::span<double> nu);

}  // namespace lbm
