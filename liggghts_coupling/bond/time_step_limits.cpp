// SPDX-License-Identifier: GPL-2.0-or-later
#include "liggghts_coupling/bond/time_step_limits.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace dem {

std::vector<StepLimit> step_limits(const StepCase& c) {
  const double k = std::max(c.normal_stiffness, c.shear_stiffness);
  const double period = std::sqrt(c.mass / k);
  const double damped = std::sqrt(1.0 + c.damping_ratio * c.damping_ratio) - c.damping_ratio;
  const double turning = c.shear_stiffness > 0.0
                             ? std::sqrt(c.inertia / (c.shear_stiffness * c.radius * c.radius))
                             : period;
  return {{"single spring, Eq 7", 2.0 * period},
          {"many springs, Eq 8", period},
          {"many springs turning, Eq 8", turning},
          {"O'Sullivan and Bray", (c.three_dimensional ? 0.17 : 0.3) * period},
          {"damped spring, Eq 11", 2.0 * period * damped},
          {"damped springs, Eq 12", period * damped}};
}

double rayleigh_limit(double mean_radius, double density, double shear_modulus,
                      double poisson_ratio) {
  return std::numbers::pi * mean_radius / (0.8766 + 0.1631 * poisson_ratio) *
         std::sqrt(density / shear_modulus);
}

}  // namespace dem
