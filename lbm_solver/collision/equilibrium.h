// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include "lbm_solver/base/unroll.h"
#include "lbm_solver/lattice/d2q9.h"

namespace lbm {

/// Density and velocity of a cell, from populations stored as deviations from rest.
template <class V>
struct Moments {
  V drho;    ///< rho - 1
  V ux, uy;  ///< velocity, lattice units
};

/// rho = Σ f_i,  rho u = Σ c_i f_i
template <class V>
[[gnu::always_inline]] inline Moments<V> moments(const V (&f)[D2Q9::Q]) {
  V drho = f[0], jx = V(0.0), jy = V(0.0);
  unroll<D2Q9::pairs>([&](auto p) __attribute__((always_inline)) {
    constexpr int i = 2 * p + 1;
    const V sum = f[i] + f[i + 1], difference = f[i] - f[i + 1];
    drho += sum;
    if constexpr (D2Q9::c[i][0] == 1) jx += difference;
    if constexpr (D2Q9::c[i][1] == 1) jy += difference;
    if constexpr (D2Q9::c[i][1] == -1) jy -= difference;
  });
  const V inverse = V(1.0) / (drho + V(1.0));
  return {drho, jx * inverse, jy * inverse};
}

/// Second-order equilibrium, split into the even and odd part of each opposite pair:
///   f_i^eq - w_i = even + odd,  f_{i+1}^eq - w_i = even - odd,
///   even = w_i (drho + rho (9/2 (c_i·u)² - 3/2 u²)),  odd = 3 w_i rho c_i·u
template <class V>
class Equilibrium {
 public:
  [[gnu::always_inline]] Equilibrium(V drho, V ux, V uy)
      : rho_(drho + V(1.0)), ux_(ux), uy_(uy), base_(drho - V(1.5) * rho_ * (ux * ux + uy * uy)) {}

  [[gnu::always_inline]] V rest() const { return V(D2Q9::w[0]) * base_; }

  struct Halves {
    V even, odd;
  };
  template <int i>
  [[gnu::always_inline]] Halves pair() const {
    V cu;
    if constexpr (D2Q9::c[i][0] == 0)
      cu = uy_;
    else if constexpr (D2Q9::c[i][1] == 0)
      cu = ux_;
    else if constexpr (D2Q9::c[i][1] == 1)
      cu = ux_ + uy_;
    else
      cu = ux_ - uy_;
    const V momentum = rho_ * cu;
    return {V(D2Q9::w[i]) * (base_ + V(4.5) * cu * momentum), V(3.0 * D2Q9::w[i]) * momentum};
  }

 private:
  V rho_, ux_, uy_, base_;
};

}  // namespace lbm
