// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include "lbm_solver/collision/parameters.h"
#include "lbm_solver/collision/tensors.h"

namespace lbm {

/// A Newtonian fluid without a turbulence model: tau is the same everywhere, and nobody computes Q
/// for it.
class ConstantViscosity {
 public:
  static constexpr bool local = false;
  explicit ConstantViscosity(const CollisionParameters& p) : tau_(p.tau) {}
  template <class L, class V>
  [[gnu::always_inline]] V tau(const Symmetric<L, V>&, const V&, const V&, const V&) const {
    return V(tau_);
  }
  template <class L, class V>
  [[gnu::always_inline]] V rate(const Symmetric<L, V>&, const V&, const V&) const {
    return V(1.0) / V(tau_);
  }

 private:
  double tau_;
};

}  // namespace lbm
