// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <string>

#include "lbm_solver/solver/plan.h"

namespace lbm {

/// How far an obstacle that moves reaches from the axis about which it turns [m].
double reach_of(const ObstacleScene& obstacle);

/// Where a table moves an obstacle fastest, as a message says it; empty for other motions.
/// @param end  of the run [s]
std::string fastest_part(const ObstacleScene& obstacle, double end);

/// How far triangles of a wall may reach from their middles in two dimensions [m], where LIGGGHTS
/// repeats the layer once and no more ("assertion failed" in its search for neighbours); not
/// positive where the layer is too thin for any.
double reach_in_layer(const Scene& scene);

/// Refuses a motion that one of the programs cannot follow, and warns of what hardly is meant: a
/// table that does not cover the run, a way out of the box, in a coupled scene a part beyond
/// a wall too; a surface that does not move along itself; a layer too thin for LIGGGHTS.
/// @throws InputError
void check_motions(const Scene& scene, Plan& plan);

}  // namespace lbm
