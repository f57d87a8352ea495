// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include "lbm_solver/collision/two_rates.h"

namespace lbm {

/// Where a covered cell lies in its solid, as factors that a term may use.
template <class V>
struct Layer {
  V surface;  ///< 1 where the solid covers the cell in part, 0 where it covers it whole
  V memory;   ///< 0 in the core, more than a few cells below the surface, else 1
};

/// The collision Ω^s that drives a covered cell towards the solid's velocity u_s, as even and odd
/// halves of each pair. `momentum_factor` is k in Σ c_i Ω_i^s = k rho (u_s - u).

/// [NobleTorczynski1998], paper A Eq 35:  Ω_i^s = f_-i - f_i + f_i^eq(rho,u_s) - f_-i^eq(rho,u)
struct NobleTorczynski {
  template <class V>
  [[gnu::always_inline]] static V momentum_factor(const Layer<V>&) {
    return V(1.0);
  }
  template <class V>
  [[gnu::always_inline]] static V rest(const V&, const V& eq, const V& solid, const Layer<V>&) {
    return solid - eq;
  }
  template <class V, class Halves>
  [[gnu::always_inline]] static Halves pair(const Halves& f, const Halves& eq, const Halves& solid,
                                            const Layer<V>&) {
    return {solid.even - eq.even, solid.odd + eq.odd - V(2.0) * f.odd};
  }
};

/// [Holdych2003], paper A Eq 39:  Ω_i^s = f_-i - f_i + f_i^eq(rho,u_s) - f_-i^eq(rho,u_s)
/// In a whole cell this is full bounce-back: trapped fluid overshoots u_s and rings with period
/// two, which throws a freely moving light particle out of the box within some ten steps.
struct Holdych {
  template <class V>
  [[gnu::always_inline]] static V momentum_factor(const Layer<V>&) {
    return V(2.0);
  }
  template <class V>
  [[gnu::always_inline]] static V rest(const V&, const V&, const V&, const Layer<V>&) {
    return V(0.0);
  }
  template <class V, class Halves>
  [[gnu::always_inline]] static Halves pair(const Halves& f, const Halves&, const Halves& solid,
                                            const Layer<V>&) {
    return {V(0.0), V(2.0) * (solid.odd - f.odd)};
  }
};

/// Holdych in surface cells, Noble–Torczynski below them, plain equilibrium of u_s in the core:
///   surface:  f_-i - f_i + f_i^eq(u_s) - f_-i^eq(u_s)
///   whole:    f_i^eq(u_s) - f_i + memory (f_-i - f_-i^eq(u))
/// As accurate as Holdych (only the first whole cells shape the flow outside), but a whole cell
/// takes the solid's velocity in one step, so that the force contains exactly the inertia of the
/// fluid inside, which the coupling gives back exactly; and the core forgets, so that nothing rings
/// there.
struct LayeredHoldych {
  template <class V>
  [[gnu::always_inline]] static V momentum_factor(const Layer<V>& layer) {
    return V(1.0) + layer.surface;
  }
  template <class V>
  [[gnu::always_inline]] static V rest(const V& f, const V& eq, const V& solid,
                                       const Layer<V>& layer) {
    return (V(1.0) - layer.surface) * (solid - f + layer.memory * (f - eq));
  }
  template <class V, class Halves>
  [[gnu::always_inline]] static Halves pair(const Halves& f, const Halves& eq, const Halves& solid,
                                            const Layer<V>& layer) {
    const V odd = solid.odd - f.odd;
    return {(V(1.0) - layer.surface) * (solid.even - f.even + layer.memory * (f.even - eq.even)),
            odd + layer.memory * (eq.odd - f.odd) + layer.surface * (solid.odd - eq.odd)};
  }
};

/// Immersed-moving-boundary collision of a covered cell:
///   f_i <- f_i + (1-B) Ω_i + B Ω_i^s
/// with Ω of TwoRates. The force on the solid is the momentum that the cell loses to Ω^s,
///   F = -B Σ c_i Ω_i^s = k B rho (u - u_s),
/// an identity that holds to round-off, so no sum over directions is needed.
template <class Term>
class CoveredCollision {
 public:
  explicit CoveredCollision(const Rates& rates) : rates_(rates) {}

  template <class V>
  struct Force {
    V x, y;  ///< on the solid, lattice units
  };

  /// @param f        populations [q] that arrived; overwritten
  /// @param weight   B [1], 0 … 1
  /// @param layer    where the cell lies in its solid
  /// @param us, vs   solid velocity at the cell centre, lattice units
  template <class V>
  [[gnu::always_inline]] Force<V> operator()(V (&f)[D2Q9::Q], V weight, const Layer<V>& layer, V us,
                                             V vs) const {
    const Moments<V> m = moments(f);
    const Equilibrium<V> eq(m.drho, m.ux, m.uy), solid(m.drho, us, vs);
    const V even_rate = (V(1.0) - weight) * V(rates_.even);
    const V odd_rate = (V(1.0) - weight) * V(rates_.odd);
    using Halves = typename Equilibrium<V>::Halves;
    f[0] +=
        even_rate * (eq.rest() - f[0]) + weight * Term::rest(f[0], eq.rest(), solid.rest(), layer);
    unroll<D2Q9::pairs>([&](auto p) __attribute__((always_inline)) {
      constexpr int i = 2 * p + 1;
      const auto e = eq.template pair<i>();
      const Halves here{V(0.5) * (f[i] + f[i + 1]), V(0.5) * (f[i] - f[i + 1])};
      const Halves s = Term::pair(here, e, solid.template pair<i>(), layer);
      const V even_gain = even_rate * (e.even - here.even) + weight * s.even;
      const V odd_gain = odd_rate * (e.odd - here.odd) + weight * s.odd;
      f[i] += even_gain + odd_gain;
      f[i + 1] += even_gain - odd_gain;
    });
    const V strength = Term::momentum_factor(layer) * weight * (m.drho + V(1.0));
    return {strength * (m.ux - us), strength * (m.uy - vs)};
  }

 private:
  Rates rates_;
};

}  // namespace lbm
