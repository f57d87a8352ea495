// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <algorithm>

#include "lbm_solver/collision/equilibrium.h"

namespace lbm {

/// Where a covered cell lies in its solid, as factors that a term may use.
template <class V>
struct Layer {
  V surface;  ///< 1 where the solid covers the cell in part, 0 where it covers it whole
  V memory;   ///< 0 in the core, more than a few cells below the surface, else 1

  /// @param layer  1 surface, 0 whole, -1 core
  [[gnu::always_inline]] static Layer of(const V& layer) {
    using std::max;
    using std::min;
    return {max(layer, V(0.0)), V(1.0) + min(layer, V(0.0))};
  }
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
  template <class V>
  [[gnu::always_inline]] static Halves<V> pair(const Halves<V>& f, const Halves<V>& eq,
                                               const Halves<V>& solid, const Layer<V>&) {
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
  template <class V>
  [[gnu::always_inline]] static Halves<V> pair(const Halves<V>& f, const Halves<V>&,
                                               const Halves<V>& solid, const Layer<V>&) {
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
  template <class V>
  [[gnu::always_inline]] static Halves<V> pair(const Halves<V>& f, const Halves<V>& eq,
                                               const Halves<V>& solid, const Layer<V>& layer) {
    const V odd = solid.odd - f.odd;
    return {(V(1.0) - layer.surface) * (solid.even - f.even + layer.memory * (f.even - eq.even)),
            odd + layer.memory * (eq.odd - f.odd) + layer.surface * (solid.odd - eq.odd)};
  }
};

/// Immersed-moving-boundary collision of a covered cell:
///   f_i <- f_i + (1-B) Ω_i + B Ω_i^s
/// with Ω of any collision operator. The force on the solid is the momentum that the cell loses to
/// Ω^s,
///   F = -B Σ c_i Ω_i^s = k B rho (u - u_s),   rho u = j without any body force,
/// an identity that holds to round-off, so no sum over directions is needed.
template <class Term>
class CoveredCollision {
 public:
  template <class V>
  struct Force {
    V x, y;  ///< on the solid, lattice units
  };

  /// @param f        populations [q] that arrived; overwritten
  /// @param collide  the operator of pure fluid
  /// @param weight   B [1], 0 … 1
  /// @param layer    where the cell lies in its solid
  /// @param us, vs   solid velocity at the cell centre, lattice units
  template <class V, class Collision>
  [[gnu::always_inline]] static Force<V> apply(V (&f)[D2Q9::Q], const Collision& collide, V weight,
                                               const Layer<V>& layer, V us, V vs) {
    const Moments<V> m = moments(f);
    const V rho = m.drho + V(1.0), inverse = V(1.0) / rho;
    const V ux = m.jx * inverse, uy = m.jy * inverse;
    const Equilibrium<V> eq(m.drho, ux, uy), solid(m.drho, us, vs);
    if constexpr (Collision::constant_rates)
      relax(f, collide, weight, layer, eq, solid);
    else
      blend(f, collide, weight, layer, eq, solid);
    const V strength = Term::momentum_factor(layer) * weight * rho;
    return {strength * (ux - us), strength * (uy - vs)};
  }

 private:
  /// Any operator: its result and the solid's, weighted.
  template <class V, class Collision>
  [[gnu::always_inline]] static void blend(V (&f)[D2Q9::Q], const Collision& collide,
                                           const V& weight, const Layer<V>& layer,
                                           const Equilibrium<V>& eq, const Equilibrium<V>& solid) {
    V fluid[D2Q9::Q];
    unroll<D2Q9::Q>([&](auto q) __attribute__((always_inline)) { fluid[q] = f[q]; });
    collide(fluid);
    const V rest = Term::rest(f[0], eq.rest(), solid.rest(), layer);
    f[0] = fluid[0] + weight * (f[0] - fluid[0] + rest);
    unroll<D2Q9::pairs>([&](auto p) __attribute__((always_inline)) {
      constexpr int i = 2 * p + 1;
      const Halves<V> here{V(0.5) * (f[i] + f[i + 1]), V(0.5) * (f[i] - f[i + 1])};
      const Halves<V> s = Term::pair(here, eq.template pair<i>(), solid.template pair<i>(), layer);
      f[i] = fluid[i] + weight * (f[i] - fluid[i] + s.even + s.odd);
      f[i + 1] = fluid[i + 1] + weight * (f[i + 1] - fluid[i + 1] + s.even - s.odd);
    });
  }

  /// The same for two constant rates, where the fluid's part is a relaxation with (1-B) times its
  /// rates.
  template <class V, class Collision>
  [[gnu::always_inline]] static void relax(V (&f)[D2Q9::Q], const Collision& collide,
                                           const V& weight, const Layer<V>& layer,
                                           const Equilibrium<V>& eq, const Equilibrium<V>& solid) {
    const V even_rate = (V(1.0) - weight) * V(collide.even_rate());
    const V odd_rate = (V(1.0) - weight) * V(collide.odd_rate());
    f[0] +=
        even_rate * (eq.rest() - f[0]) + weight * Term::rest(f[0], eq.rest(), solid.rest(), layer);
    unroll<D2Q9::pairs>([&](auto p) __attribute__((always_inline)) {
      constexpr int i = 2 * p + 1;
      const auto e = eq.template pair<i>();
      const Halves<V> here{V(0.5) * (f[i] + f[i + 1]), V(0.5) * (f[i] - f[i + 1])};
      const Halves<V> s = Term::pair(here, e, solid.template pair<i>(), layer);
      const V even_gain = even_rate * (e.even - here.even) + weight * s.even;
      const V odd_gain = odd_rate * (e.odd - here.odd) + weight * s.odd;
      f[i] += even_gain + odd_gain;
      f[i + 1] += even_gain - odd_gain;
    });
  }
};

}  // namespace lbm
