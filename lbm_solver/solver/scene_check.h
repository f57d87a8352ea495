// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include "lbm_solver/solver/plan.h"

namespace lbm {

/// Refuses what the chosen step cannot carry, and adds warnings to the plan: what would run, but
/// hardly as it was meant.
/// @throws InputError
void check_meaning(const Scene& scene, Plan& plan);

}  // namespace lbm
