// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include "lbm_solver/solver/plan.h"

namespace lbm {

/// Refuses a mesh that is smaller than a cell, and warns of an image that leaves a gap beside it,
/// or, with the other obstacles, no way for a flow that is driven.
/// @throws InputError
void check_shapes(const Scene& scene, Plan& plan);

}  // namespace lbm
