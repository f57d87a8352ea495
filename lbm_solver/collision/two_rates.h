// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include "lbm_solver/collision/equilibrium.h"
#include "lbm_solver/collision/forcing.h"
#include "lbm_solver/collision/moments.h"

namespace lbm {

/// How the relaxation time of the odd half follows from that of the even half.

/// BGK: both are equal.
struct EqualRates {
  static constexpr bool fixed_magic = false;
  explicit EqualRates(const CollisionParameters&) {}
  template <class V>
  [[gnu::always_inline]] V odd_tau(const V& tau) const {
    return tau;
  }
  /// The odd rate of an even rate.
  template <class V>
  [[gnu::always_inline]] V odd_rate(const V& even_rate) const {
    return even_rate;
  }
};

/// TRT [Ginzburg 2008]: Λ = (τ⁺ - ½)(τ⁻ - ½) is kept. With Λ = 3/16 a half-way wall lies exactly
/// half-way at every viscosity.
struct MagicRate {
  static constexpr bool fixed_magic = true;
  explicit MagicRate(const CollisionParameters& p) : magic(p.magic) {}
  template <class V>
  [[gnu::always_inline]] V odd_tau(const V& tau) const {
    return V(magic) / (tau - V(0.5)) + V(0.5);
  }
  /// The odd rate of an even rate, ω⁻ = 2 (2 - ω⁺) / (4 Λ ω⁺ + 2 - ω⁺).
  template <class V>
  [[gnu::always_inline]] V odd_rate(const V& even_rate) const {
    const V rest = V(2.0) - even_rate;
    return V(2.0) * rest / (V(4.0 * magic) * even_rate + rest);
  }
  double magic;
};

/// Relaxes the even and odd halves of the populations:
///   f± <- f± + ω± (f±^eq - f±) + (1 - ω±/2) S±,   ω⁺ = 1/τ, ω⁻ by the odd rule
/// @param f       populations [q] that arrived, as deviations from rest; overwritten
/// @param eddies  share of the eddy viscosity (EddyField), 1 where there is no such field
template <class L, class OddRule, class Viscosity, class Force>
class TwoRates {
 public:
  using Set = L;
  explicit TwoRates(const CollisionParameters& p)
      : odd_rule_(p),
        viscosity_(p),
        force_(p),
        even_rate_(1.0 / p.tau),
        odd_rate_(1.0 / odd_rule_.odd_tau(p.tau)) {}

  /// The rates are the same in every cell, and nothing is added to the relaxation.
  static constexpr bool constant_rates = !Viscosity::local && !Force::on;
  /// Λ is the same in every cell: what a covered cell by resistance needs.
  static constexpr bool fixed_magic = OddRule::fixed_magic;
  double even_rate() const { return even_rate_; }
  double odd_rate() const { return odd_rate_; }

  static constexpr bool local_viscosity = Viscosity::local, forced = Force::on;
  const Force& force() const { return force_; }
  template <class V>
  [[gnu::always_inline]] V relaxation_time(const V (&f)[L::Q], const Moments<L, V>& m,
                                           const V& fluid, const V& eddies) const {
    return local_tau<L>(f, m, fluid, eddies, viscosity_, force_);
  }

  template <class V>
  [[gnu::always_inline]] void operator()(V (&f)[L::Q], const V& eddies) const {
    const Moments<L, V> m = moments<L>(f);
    const Vector<L, V> u = velocity<L>(m, force_);
    V even_rate(even_rate_), odd_rate(odd_rate_);
    if constexpr (Viscosity::local) {
      const Symmetric<L, V> q = non_equilibrium<L>(f, m.drho, u, force_);
      const Halves<V> rates = viscosity_.rates(q, m.drho + V(1.0), eddies, odd_rule_);
      even_rate = rates.even;
      odd_rate = rates.odd;
    }
    const Equilibrium<L, V> eq(m.drho, u);
    f[0] += even_rate * (eq.rest() - f[0]);
    if constexpr (Force::on) f[0] += (V(1.0) - V(0.5) * even_rate) * force_.rest(u);
    unroll<L::pairs>([&](auto p) __attribute__((always_inline)) {
      constexpr int i = 2 * p + 1;
      const auto e = eq.template pair<i>();
      const V even = V(0.5) * (f[i] + f[i + 1]), odd = V(0.5) * (f[i] - f[i + 1]);
      V even_gain = even_rate * (e.even - even), odd_gain = odd_rate * (e.odd - odd);
      if constexpr (Force::on) {
        const auto s = force_.template pair<i>(u);
        even_gain += (V(1.0) - V(0.5) * even_rate) * s.even;
        odd_gain += (V(1.0) - V(0.5) * odd_rate) * s.odd;
      }
      f[i] += even_gain + odd_gain;
      f[i + 1] += even_gain - odd_gain;
    });
  }

 private:
  OddRule odd_rule_;
  Viscosity viscosity_;
  Force force_;
  double even_rate_, odd_rate_;
};

}  // namespace lbm
