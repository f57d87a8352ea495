// SPDX-License-Identifier: GPL-2.0-or-later
/// Moments of a cell's populations, and what they say of its velocity and its stress.
#pragma once

#include "lbm_solver/collision/tensors.h"

namespace lbm {

/// Density and momentum of a cell, from populations stored as deviations from rest.
template <class L, class V>
struct Moments {
  V drho;          ///< rho - 1
  Vector<L, V> j;  ///< Σ c_i f_i
};

/// rho = Σ f_i,  j = Σ c_i f_i
template <class L, class V>
[[gnu::always_inline]] inline Moments<L, V> moments(const V (&f)[L::Q]) {
  Moments<L, V> m{f[0], {}};
  unroll<L::D>([&](auto a) __attribute__((always_inline)) { m.j[a] = V(0.0); });
  unroll<L::pairs>([&](auto p) __attribute__((always_inline)) {
    constexpr int i = 2 * p + 1;
    const V difference = f[i] - f[i + 1];
    m.drho += f[i] + f[i + 1];
    unroll<L::D>([&](auto a) __attribute__((always_inline)) {
      if constexpr (L::c[i][a] == 1) m.j[a] += difference;
      if constexpr (L::c[i][a] == -1) m.j[a] -= difference;
    });
  });
  return m;
}

/// Velocity of a cell, half a body force included.
template <class L, class V, class Force>
[[gnu::always_inline]] inline Vector<L, V> velocity(const Moments<L, V>& m, const Force& force) {
  const V inverse = V(1.0) / (m.drho + V(1.0));
  Vector<L, V> u = force.momentum(m.j);
  unroll<L::D>([&](auto a) __attribute__((always_inline)) { u[a] *= inverse; });
  return u;
}

/// Second moments of the non-equilibrium populations, Q_ab = Σ c_a c_b f - rho/3 δ_ab - rho u_a
/// u_b, plus the force's part ½(F_a u_b + u_a F_b) where there is one.
template <class L, class Force, class V>
[[gnu::always_inline]] inline Symmetric<L, V> non_equilibrium(const V (&f)[L::Q], const V& drho,
                                                              const Vector<L, V>& u,
                                                              const Force& force) {
  Symmetric<L, V> q;
  const V rho = drho + V(1.0), third = V(1.0 / 3.0) * drho;
  Symmetric<L, V>::each_pair([&](auto a, auto b) __attribute__((always_inline)) {
    q.template get<a, b>() = a == b ? -third - rho * u[a] * u[a] : -rho * u[a] * u[b];
  });
  unroll<L::pairs>([&](auto p) __attribute__((always_inline)) {
    constexpr int i = 2 * p + 1;
    const V sum = f[i] + f[i + 1];
    Symmetric<L, V>::each_pair([&](auto a, auto b) __attribute__((always_inline)) {
      constexpr int c = L::c[i][a] * L::c[i][b];
      if constexpr (c == 1) q.template get<a, b>() += sum;
      if constexpr (c == -1) q.template get<a, b>() -= sum;
    });
  });
  if constexpr (Force::on) force.add_to(q, u);
  return q;
}

/// Relaxation time of a cell where the viscosity is a function of the shear rate there.
/// @param fluid      part of the cell that is fluid
/// @param eddies     share of the eddy viscosity (EddyField)
/// @param viscosity  a class of the room viscosity/ @param force  a class of forcing.h
template <class L, class Viscosity, class Force, class V>
[[gnu::always_inline]] inline V local_tau(const V (&f)[L::Q], const Moments<L, V>& m,
                                          const V& fluid, const V& eddies,
                                          const Viscosity& viscosity, const Force& force) {
  return viscosity.tau(non_equilibrium<L>(f, m.drho, velocity<L>(m, force), force), m.drho + V(1.0),
                       fluid, eddies);
}

}  // namespace lbm
