// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include "lbm_solver/base/unroll.h"
#include "lbm_solver/lattice/d2q9.h"

namespace lbm {

/// Even and odd half of a pair of opposite populations: f_i = even + odd, f_{i+1} = even - odd.
template <class V>
struct Halves {
  V even, odd;
};

/// Density and momentum of a cell, from populations stored as deviations from rest.
template <class V>
struct Moments {
  V drho;    ///< rho - 1
  V jx, jy;  ///< Σ c_i f_i
};

/// rho = Σ f_i,  j = Σ c_i f_i
template <class V>
[[gnu::always_inline]] inline Moments<V> moments(const V (&f)[D2Q9::Q]) {
  Moments<V> m{f[0], V(0.0), V(0.0)};
  unroll<D2Q9::pairs>([&](auto p) __attribute__((always_inline)) {
    constexpr int i = 2 * p + 1;
    const V difference = f[i] - f[i + 1];
    m.drho += f[i] + f[i + 1];
    if constexpr (D2Q9::c[i][0] == 1) m.jx += difference;
    if constexpr (D2Q9::c[i][1] == 1) m.jy += difference;
    if constexpr (D2Q9::c[i][1] == -1) m.jy -= difference;
  });
  return m;
}

/// c_i · (x, y) for the first direction i of a pair.
template <int i, class V>
[[gnu::always_inline]] inline V along(const V& x, const V& y) {
  if constexpr (D2Q9::c[i][0] == 0)
    return y;
  else if constexpr (D2Q9::c[i][1] == 0)
    return x;
  else if constexpr (D2Q9::c[i][1] == 1)
    return x + y;
  else
    return x - y;
}

/// Second-order equilibrium, split into the halves of each opposite pair:
///   f_i^eq - w_i = even + odd,  f_{i+1}^eq - w_i = even - odd,
///   even = w_i (drho + rho (9/2 (c_i·u)² - 3/2 u²)),  odd = 3 w_i rho c_i·u
template <class V>
class Equilibrium {
 public:
  [[gnu::always_inline]] Equilibrium(V drho, V ux, V uy)
      : rho_(drho + V(1.0)), ux_(ux), uy_(uy), base_(drho - V(1.5) * rho_ * (ux * ux + uy * uy)) {}

  [[gnu::always_inline]] V rest() const { return V(D2Q9::w[0]) * base_; }

  template <int i>
  [[gnu::always_inline]] Halves<V> pair() const {
    const V cu = along<i>(ux_, uy_), momentum = rho_ * cu;
    return {V(D2Q9::w[i]) * (base_ + V(4.5) * cu * momentum), V(3.0 * D2Q9::w[i]) * momentum};
  }

 private:
  V rho_, ux_, uy_, base_;
};

}  // namespace lbm
