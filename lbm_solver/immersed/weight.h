// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <algorithm>
#include <experimental/simd>

namespace lbm {

/// How the weight B of the solid's collision follows from the solid fraction ε of a cell.
enum class WeightRule {
  Viscous,   ///< B(ε, τ) = ε (τ - ½) / ((1 - ε) + (τ - ½)), paper A Eq 34
  Fraction,  ///< B = ε
};

/// Weight of the solid's collision in a covered cell.
struct ImmersedWeight {
  WeightRule rule = WeightRule::Viscous;
  double tau = 1.0;  ///< relaxation time of the viscosity

  /// @param eps  solid fraction; the sum over all solids in the cell, of which at most 1 is used
  template <class V>
  V operator()(const V& eps) const {
    using std::min;
    const V e = min(eps, V(1.0)), s(tau - 0.5);
    return rule == WeightRule::Fraction ? e : e * s / ((V(1.0) - e) + s);
  }
  /// ε of a weight.
  double fraction(double weight) const {
    const double s = tau - 0.5;
    return rule == WeightRule::Fraction ? weight : weight * (1.0 + s) / (weight + s);
  }
};

}  // namespace lbm
