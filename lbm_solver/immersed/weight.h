// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include "lbm_solver/base/choices.h"

namespace lbm {

/// Weight of the solid's collision in a covered cell.
///
/// Why `Balanced`: a covered cell resists with 2B/(1-B) in units of the velocity between two
/// collisions. Over the viscosity s/3 that should depend on ε alone, or a body grows and shrinks
/// with the time step; c = 1 - s makes it so, but the cell's own viscosity then rises with s and
/// the sum overshoots as much as c = 1 falls short. Half-way between, the drag of a sphere ten
/// cells across moves by 0.3 % from τ = 0.55 to 1.5, with c = 1 by 2.5 %.
class ImmersedWeight {
 public:
  explicit ImmersedWeight(WeightRule rule, double tau = 1.0)
      : tau(tau),
        constant_(rule == WeightRule::Fraction ? 0.0 : 1.0),
        slope_(rule == WeightRule::Balanced ? 0.5 : 0.0) {}

  /// B of a solid fraction of at most 1, where the viscosity has the relaxation time s + 1/2.
  template <class V>
  [[gnu::always_inline]] V operator()(const V& eps, const V& s) const {
    return eps * s / ((V(1.0) - eps) * (V(constant_) - V(slope_) * s) + s);
  }

  double tau;  ///< relaxation time where it is the same everywhere

 private:
  double constant_, slope_;  // c = constant - slope s
};

}  // namespace lbm
