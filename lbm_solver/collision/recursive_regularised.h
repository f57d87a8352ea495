// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include "lbm_solver/collision/forcing.h"
#include "lbm_solver/collision/moment_basis.h"
#include "lbm_solver/collision/moments.h"

namespace lbm {

/// Recursive regularised collision [Malaspinas2015, Coreixas2017]: the populations are rebuilt from
/// rho, u and Q alone, with all Hermite terms that the lattice has. Their non-equilibrium parts
/// follow from the second order's: each pair of the term's velocities in turn gives way to Q,
///   a_abc… = rho u_a u_b u_c … + (1 - 1/τ) Σ_pairs Q_ab u_c …,
/// e.g. Q_xx u_y + 2 u_x Q_xy for xxy. A body force adds S_i / 2.
template <class L, class Viscosity, class Force>
class RecursiveRegularised {
 public:
  using Set = L;
  static constexpr bool constant_rates = false, fixed_magic = false;  ///< see TwoRates
  explicit RecursiveRegularised(const CollisionParameters& p) : viscosity_(p), force_(p) {}

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
    const V rho = m.drho + V(1.0);
    const Vector<L, V> u = velocity<L>(m, force_);
    Symmetric<L, V> q = non_equilibrium<L>(f, m.drho, u, force_);
    const V keep = V(1.0) - viscosity_.rate(q, rho, eddies);
    for (V& part : q.at) part *= keep;
    Coefficients<L, V> a;
    a.each([&](auto x, auto y, auto z)
               __attribute__((always_inline)) { a.at[x][y][z] = hermite<x, y, z>(rho, u, q); });
    a.at[0][0][0] = m.drho;  // populations are stored without the part at rest
    unroll<L::D>([&](auto axis) __attribute__((always_inline)) {
      a.template each_line<axis>([](V & a0, V&, V & a2) __attribute__((always_inline)) {
        a2 += V(1.0 / 3.0) * a0;  // the polynomial is c² - 1/3
      });
    });
    to_populations<L>(a, f);
    if constexpr (Force::on) {
      f[0] += V(0.5) * force_.rest(u);
      unroll<L::pairs>([&](auto p) __attribute__((always_inline)) {
        constexpr int i = 2 * p + 1;
        const auto s = force_.template pair<i>(u);
        f[i] += V(0.5) * (s.even + s.odd);
        f[i + 1] += V(0.5) * (s.even - s.odd);
      });
    }
  }

 private:
  /// ∏ u_a^n_a
  template <int x, int y, int z, class V>
  [[gnu::always_inline]] static V product(const Vector<L, V>& u) {
    if constexpr (x > 0) {
      if constexpr (x + y + z == 1)
        return u[0];
      else
        return u[0] * product<x - 1, y, z>(u);
    } else if constexpr (y > 0) {
      if constexpr (y + z == 1)
        return u[1];
      else
        return u[1] * product<0, y - 1, z>(u);
    } else if constexpr (z > 0) {
      if constexpr (z == 1)
        return u[L::D - 1];
      else
        return u[L::D - 1] * product<0, 0, z - 1>(u);
    } else {
      return V(1.0);
    }
  }

  /// Hermite coefficient with powers x, y, z; `kept` is what the collision keeps of Q.
  template <int x, int y, int z, class V>
  [[gnu::always_inline]] static V hermite(const V& rho, const Vector<L, V>& u,
                                          const Symmetric<L, V>& kept) {
    constexpr int power[] = {x, y, z};
    V value = rho;
    if constexpr (x + y + z > 0) value *= product<x, y, z>(u);
    Symmetric<L, V>::each_pair([&](auto a, auto b) __attribute__((always_inline)) {
      constexpr int pairs = a == b ? power[a] / 2 : power[a] * power[b];
      constexpr auto less = [](int axis, int i, int j) { return (axis == i) + (axis == j); };
      if constexpr (pairs > 0) {
        const V& part = kept.template get<a, b>();
        if constexpr (x + y + z == 2)
          value += part;
        else
          value +=
              V(pairs) * part * product<x - less(0, a, b), y - less(1, a, b), z - less(2, a, b)>(u);
      }
    });
    return value;
  }

  Viscosity viscosity_;
  Force force_;
};

}  // namespace lbm
