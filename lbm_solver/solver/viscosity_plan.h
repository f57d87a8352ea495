// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include "lbm_solver/solver/plan.h"

namespace lbm {

/// Where the viscosity depends on the shear rate: puts its table into the plan's kernel, refuses
/// bounds that the lattice cannot carry, and adds warnings. Does nothing for a Newtonian fluid.
/// The plan's step must be known.
/// @throws InputError
void plan_viscosity(const Scene& scene, Plan& plan);

/// What `lbm check` says of it, one line each: law, range, relaxation times, dimensionless groups;
/// empty for a Newtonian fluid.
std::vector<std::string> describe_viscosity(const Scene& scene, const Plan& plan);

}  // namespace lbm
