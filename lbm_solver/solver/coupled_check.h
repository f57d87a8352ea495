// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include "lbm_solver/solver/plan.h"

namespace lbm {

/// Adds warnings to the plan of a coupled scene: of its interval, its particles and their script.
void check_coupled(const Scene& scene, Plan& plan);

}  // namespace lbm
