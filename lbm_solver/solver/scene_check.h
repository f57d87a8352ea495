// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include "lbm_solver/solver/plan.h"

namespace lbm {

/// Refuses a scene whose parts do not fit together, whatever its step: particles and obstacles
/// outside the box or in each other, two boundaries on the same part of a side.
/// @throws InputError
void check_places(const Scene& scene);

/// Refuses what the chosen step cannot carry, and adds warnings to the plan: what would run, but
/// hardly as it was meant.
/// @throws InputError
void check_meaning(const Scene& scene, Plan& plan);

}  // namespace lbm
