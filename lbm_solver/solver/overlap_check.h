// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include "lbm_solver/solver/plan.h"

namespace lbm {

/// Warns of obstacles that lie in each other, by their numbers: which load is then counted where.
/// Grains of a file and hollow obstacles are left out; of those that move the start is looked at.
/// @throws InputError  an obstacle is off the cells
void check_overlaps(const Scene& scene, Plan& plan);

}  // namespace lbm
