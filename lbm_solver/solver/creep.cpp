// SPDX-License-Identifier: GPL-2.0-or-later
#include "lbm_solver/solver/creep.h"

#include <algorithm>
#include <cmath>

namespace lbm {
namespace {

constexpr double kBeginning = 1e-10,
                 kApart = 1.002;  // shear rates of the quadrature, over the wall's
constexpr int kHalvings = 80;

/// Stress of the law without bounds [Pa].
double stress_without_bounds(const FluidScene& fluid, double rate) {
  return fluid.law.yield_stress + fluid.law.consistency * std::pow(rate, fluid.law.index);
}

/// ∫ σ γ̇ dσ of that law up to the stress at the walls, ½ σ² γ̇ - ½ ∫ σ² dγ̇.
double flow_without_bounds(const FluidScene& fluid, double rate) {
  const double y = fluid.law.yield_stress, k = fluid.law.consistency, n = fluid.law.index;
  const double viscous = k * std::pow(rate, n), wall = y + viscous;
  const double squares =
      rate * (viscous * viscous / (2.0 * n + 1.0) + 2.0 * viscous * y / (n + 1.0) + y * y);
  return 0.5 * (wall * wall * rate - squares);
}

}  // namespace

double plug_in_channel(const FluidScene& fluid, double wall_rate) {
  return fluid.law.yield_stress / stress_without_bounds(fluid, wall_rate);
}

double creep_in_channel(const FluidScene& fluid, const ViscosityLaw& law, double wall_rate) {
  const auto stress = [&](double rate) { return fluid.density * rate * law(rate); };
  const double wall = stress_without_bounds(fluid, wall_rate);
  double low = std::log(kBeginning * wall_rate), high = std::log(wall_rate / kBeginning);
  for (int k = 0; k < kHalvings; ++k) {
    const double middle = 0.5 * (low + high);
    (stress(std::exp(middle)) < wall ? low : high) = middle;
  }
  const double last = std::exp(0.5 * (low + high));
  double rate = kBeginning * last, at = stress(rate), sum = at * at * rate / 3.0;
  while (rate < last) {
    const double next = std::min(last, kApart * rate), then = stress(next);
    sum += 0.5 * (at * rate + then * next) * (then - at);
    rate = next;
    at = then;
  }
  return sum / flow_without_bounds(fluid, wall_rate) - 1.0;
}

}  // namespace lbm
