// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <string>

#include "lbm_solver/immersed/resistance.h"

namespace lbm {

/// Share B of the solid in the velocity of a covered cell, (1-B) u + B u_s, where u is that of the
/// populations that arrived: the weight of the cell's collision, or with a term by resistance half
/// of the momentum that it exchanges, which is the velocity half-way through the collision. It is 1
/// where a cell is covered whole.
///
/// The populations alone do not show how a mixed cell moves: below the surface they hold what
/// streaming brought there, some tens of per cent of the flow outside even in a body at rest.
class SolidShare {
 public:
  /// @param term        one of known_solid_terms(), or "none"
  /// @param parameters  of the collision: relaxation time and Λ
  SolidShare(const std::string& term, WeightRule rule, const CollisionParameters& parameters)
      : by_resistance_(by_resistance(term)),
        weight_(rule, parameters.tau),
        mu_zero_(2.0 - 16.0 / 3.0 * parameters.magic) {}

  /// @param cover  as in CoverBlock
  /// @param tau    relaxation time of the cell
  template <class L, class V>
  V of(const V& cover, const V& tau) const {
    const V eps = fraction_of(cover);
    V share = by_resistance_
                  ? V(0.5) * surface_exchange<L, V>(eps, tau - V(0.5), V(mu_zero_)).momentum
                  : weight_(eps, tau);
    where(eps >= V(kWhole), share) = V(1.0);
    return share;
  }

 private:
  bool by_resistance_;
  ImmersedWeight weight_;
  double mu_zero_;
};

}  // namespace lbm
