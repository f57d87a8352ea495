// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include "lbm_solver/solver/plan.h"

namespace lbm {

/// Drives that do not do what the scene wants of them: stresses that a yield stress holds, and
/// flows that are held too slowly for their change in time, or for round-off. Adds warnings.
void check_driven(const Scene& scene, Plan& plan);

/// Stress on the walls of a plane channel without solids which a body force or a difference of
/// pressures drives [Pa], at its largest; 0 where the scene is none.
double channel_wall_stress(const Scene& scene);

}  // namespace lbm
