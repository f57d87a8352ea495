// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include "lbm_solver/solver/fluid.h"
#include "lbm_solver/viscosity/relaxation_table.h"

namespace lbm {

/// What the flow makes of a viscosity that depends on the shear rate, over all cells of the box
/// that are not solid whole.
struct ViscosityUse {
  double at_rest_bound = 0.0;   ///< share of cells slower than where the law begins
  double at_shear_bound = 0.0;  ///< share of cells faster than where it ends
  double largest_shear = 0.0;   ///< a step
  double mean_viscosity = 0.0;  ///< lattice units
};

/// Of the present state. Collective.
ViscosityUse viscosity_use(const Fluid& fluid, const RelaxationTable& table);

}  // namespace lbm
