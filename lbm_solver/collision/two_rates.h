// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include "lbm_solver/collision/equilibrium.h"

namespace lbm {

/// Relaxation rates of the even and odd halves of the populations.
///
/// BGK has equal rates 1/tau. TRT [Ginzburg 2008] takes 1/tau for the even half, which sets the
/// viscosity nu = (tau - 1/2)/3, and chooses the odd one so that Λ = (τ⁺ - ½)(τ⁻ - ½) is fixed:
/// with Λ = 3/16 a half-way wall lies exactly half-way at every viscosity.
struct Rates {
  double even, odd;

  static constexpr Rates bgk(double tau) { return {1.0 / tau, 1.0 / tau}; }
  static constexpr Rates trt(double tau, double magic) {
    return {1.0 / tau, 1.0 / (magic / (tau - 0.5) + 0.5)};
  }
};

/// Two-relaxation-time collision of a cell of pure fluid:
///   f± <- f± + ω± (f±^eq - f±)
/// @param f  populations [q] that arrived, as deviations from rest; overwritten
class TwoRates {
 public:
  explicit TwoRates(const Rates& rates) : rates_(rates) {}
  const Rates& rates() const { return rates_; }

  template <class V>
  [[gnu::always_inline]] void operator()(V (&f)[D2Q9::Q]) const {
    const Moments<V> m = moments(f);
    const Equilibrium<V> eq(m.drho, m.ux, m.uy);
    const V even_rate(rates_.even), odd_rate(rates_.odd);
    f[0] += even_rate * (eq.rest() - f[0]);
    unroll<D2Q9::pairs>([&](auto p) __attribute__((always_inline)) {
      constexpr int i = 2 * p + 1;
      const auto e = eq.template pair<i>();
      const V even = V(0.5) * (f[i] + f[i + 1]), odd = V(0.5) * (f[i] - f[i + 1]);
      const V even_gain = even_rate * (e.even - even), odd_gain = odd_rate * (e.odd - odd);
      f[i] += even_gain + odd_gain;
      f[i + 1] += even_gain - odd_gain;
    });
  }

 private:
  Rates rates_;
};

}  // namespace lbm
