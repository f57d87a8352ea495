// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <algorithm>
#include <experimental/simd>

namespace lbm {

/// How the weight B of the solid's collision follows from the solid fraction ε of a cell; s = τ -
/// ½:
///   B = ε s / ((1 - ε) c(s) + s)
enum class WeightRule {
  Viscous,   ///< c = 1, paper A Eq 34
  Balanced,  ///< c = 1 - s/2
  Fraction,  ///< c = 0: B = ε
};

/// Why `Balanced`: a covered cell resists with 2B/(1-B) in units of the velocity between two
/// collisions. Over the viscosity s/3 that should depend on ε alone, or a body grows and shrinks
/// with the time step; c = 1 - s makes it so, but the cell's own viscosity then rises with s and
/// the sum overshoots as much as c = 1 falls short. Half-way between, the drag of a sphere ten
/// cells across moves by 0.3 % from τ = 0.55 to 1.5, with c = 1 by 2.5 %.
struct ResistanceOfWeight {
  double constant = 1.0, slope = 0.0;  ///< c = constant - slope s

  explicit ResistanceOfWeight(WeightRule rule)
      : constant(rule == WeightRule::Fraction ? 0.0 : 1.0),
        slope(rule == WeightRule::Balanced ? 0.5 : 0.0) {}
  /// B of a fraction of at most 1.
  template <class V>
  [[gnu::always_inline]] V weight(const V& eps, const V& s) const {
    return eps * s / ((V(1.0) - eps) * (V(constant) - V(slope) * s) + s);
  }
};

/// Weight of the solid's collision in a covered cell.
struct ImmersedWeight {
  WeightRule rule = WeightRule::Viscous;
  double tau = 1.0;  ///< relaxation time of the viscosity

  /// @param eps  solid fraction; the sum over all solids in the cell, of which at most 1 is used
  template <class V>
  V operator()(const V& eps) const {
    using std::min;
    const V e = min(eps, V(1.0));
    return rule == WeightRule::Fraction ? e : ResistanceOfWeight(rule).weight(e, V(tau - 0.5));
  }
  /// ε of a weight.
  double fraction(double weight) const {
    const ResistanceOfWeight r(rule);
    const double s = tau - 0.5, c = r.constant - r.slope * s;
    return rule == WeightRule::Fraction ? weight : weight * (c + s) / (c * weight + s);
  }
};

}  // namespace lbm
