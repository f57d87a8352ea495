// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include "lbm_solver/collision/tensors.h"

namespace lbm {

/// Second-order equilibrium, split into the halves of each opposite pair:
///   f_i^eq - w_i = even + odd,  f_{i+1}^eq - w_i = even - odd,
///   even = w_i (drho + rho (9/2 (c_i·u)² - 3/2 u²)),  odd = 3 w_i rho c_i·u
template <class L, class V>
class Equilibrium {
 public:
  [[gnu::always_inline]] Equilibrium(V drho, const Vector<L, V>& u)
      : rho_(drho + V(1.0)), u_(u), base_(drho - V(1.5) * rho_ * dot<L>(u, u)) {}

  [[gnu::always_inline]] V rest() const { return V(L::w[0]) * base_; }

  template <int i>
  [[gnu::always_inline]] Halves<V> pair() const {
    const V cu = along<L, i>(u_), momentum = rho_ * cu;
    return {V(L::w[i]) * (base_ + V(4.5) * cu * momentum), V(3.0 * L::w[i]) * momentum};
  }

 private:
  V rho_;
  Vector<L, V> u_;
  V base_;
};

}  // namespace lbm
