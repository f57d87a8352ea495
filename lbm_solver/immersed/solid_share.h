// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include "lbm_solver/immersed/resistance.h"

namespace lbm {

/// Share B of the solid in the velocity of a covered cell, (1-B) u + B u_s, where u is that of the
/// populations that arrived: the weight of the cell's collision, or with a term by resistance half
/// of the momentum that it exchanges. It is 1 where a cell is covered whole.
///
/// With a term by resistance the ghost's part Γ z of that exchange goes off as well. Then it is the
/// velocity half-way through the collision: the mean of what enters and leaves the cell, so that
/// the mean over a box is the flux through it.
///
/// The populations alone do not show how a mixed cell moves: below the surface they hold what
/// streaming brought there, some tens of per cent of the flow outside even in a body at rest.
class SolidShare {
 public:
  /// @param parameters  of the collision: relaxation time and Λ
  SolidShare(SolidTerm term, WeightRule rule, const CollisionParameters& parameters)
      : by_resistance_(by_resistance(term)),
        weight_(rule, parameters.tau),
        mu_zero_(2.0 - 16.0 / 3.0 * parameters.magic) {}

  /// @param cover  as in CoverBlock
  /// @param tau    relaxation time of the cell
  template <class L, class V>
  V of(const V& cover, const V& tau) const {
    const V eps = fraction_of(cover);
    V share = by_resistance_ ? V(0.5) * exchange<L>(eps, tau).momentum : weight_(eps, tau - V(0.5));
    where(eps >= V(kWhole), share) = V(1.0);
    return share;
  }

  bool takes_ghost() const { return by_resistance_; }
  /// Γ: a component of the momentum half-way through the collision has Γ z less. @param cover, tau
  /// as above
  template <class L, class V>
  V of_ghost(const V& cover, const V& tau) const {
    const V eps = fraction_of(cover);
    V part = V(0.5) * exchange<L>(eps, tau).cross;
    where(eps >= V(kWhole), part) = V(0.0);
    return part;
  }

 private:
  template <class L, class V>
  OddExchange<V> exchange(const V& eps, const V& tau) const {
    return surface_exchange<L, V>(eps, tau - V(0.5), V(mu_zero_));
  }

  bool by_resistance_;
  ImmersedWeight weight_;
  double mu_zero_;
};

}  // namespace lbm
