// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <string>
#include <vector>

#include "lbm_solver/base/scene.h"

namespace lbm {

/// Something in a scene that sets the fluid or the particles in motion, and the speed that it can
/// give: the smaller of what viscosity and what inertia allow, so right in its order of magnitude.
struct Drive {
  double speed;      ///< [m/s]
  std::string what;  ///< with its value, "fluid.body_force = 0.5 m/s²"
};

/// Velocities of boundaries, obstacles and the initial state, body force, pressure differences, and
/// the weight of the particles in the fluid. The fastest first; empty where nothing drives.
std::vector<Drive> drives(const Scene& scene);

/// Largest difference between the pressures of boundaries, or across periodic sides [Pa].
double largest_pressure(const Scene& scene);

/// Mean speed of a flow that is held through an opening [m/s]; 0 without one.
double opening_speed(const Scene& scene, const BoundaryScene& opening);

/// Mean speed of a flow that is held over the cross-section of the box [m/s]; 0 without one.
double mean_speed(const Scene& scene);

}  // namespace lbm
