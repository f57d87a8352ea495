// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include "lbm_solver/io/cell_fields.h"
#include "lbm_solver/solver/fluid.h"
#include "lbm_solver/solver/plan.h"

namespace lbm {

/// What a frame shows of every cell, in SI units: pressure, velocity and, where there are solids,
/// what they cover. The fluid must outlive it.
/// @param viscosity  that too
CellFields shown_cells(Fluid& fluid, const Plan& plan, bool viscosity);

/// Mean over the box of the momentum that has arrived in its cells. It is added up in whole
/// numbers: the same bit for bit on any ranks. Collective.
Vec3 mean_arrived_momentum(const Fluid& fluid);

}  // namespace lbm
