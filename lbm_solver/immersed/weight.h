// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <algorithm>

namespace lbm {

/// Weight of the solid's collision in a covered cell, paper A Eq 34:
///   B(ε, τ) = ε (τ - ½) / ((1 - ε) + (τ - ½))
/// @param eps  solid fraction; the sum over all solids in the cell, at most 1 is used
/// @param tau  relaxation time of the viscosity
inline double immersed_weight(double eps, double tau) {
  const double e = std::min(eps, 1.0), s = tau - 0.5;
  return e * s / ((1.0 - e) + s);
}

}  // namespace lbm
