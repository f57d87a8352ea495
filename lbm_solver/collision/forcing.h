// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include "lbm_solver/collision/equilibrium.h"
#include "lbm_solver/collision/parameters.h"
#include "lbm_solver/turbulence/smagorinsky.h"

namespace lbm {

/// No body force: the velocity is j/rho and nothing is added.
class NoForce {
 public:
  static constexpr bool on = false;
  explicit NoForce(const CollisionParameters&) {}
  template <class V>
  [[gnu::always_inline]] V momentum_x(const V& j) const {
    return j;
  }
  template <class V>
  [[gnu::always_inline]] V momentum_y(const V& j) const {
    return j;
  }
};

/// Uniform body force [GuoZhengShi2002]. The velocity takes half of it, rho u = j + F/2, and the
/// populations the source
///   S_i = w_i (3 c_i·F + 9 (c_i·u)(c_i·F) - 3 u·F),   Σ S_i = 0, Σ c_i S_i = F
class GuoForce {
 public:
  static constexpr bool on = true;
  explicit GuoForce(const CollisionParameters& p) : x_(p.force_x), y_(p.force_y) {}
  double x() const { return x_; }
  double y() const { return y_; }

  template <class V>
  [[gnu::always_inline]] V momentum_x(const V& j) const {
    return j + V(0.5 * x_);
  }
  template <class V>
  [[gnu::always_inline]] V momentum_y(const V& j) const {
    return j + V(0.5 * y_);
  }
  template <class V>
  [[gnu::always_inline]] V rest(const V& ux, const V& uy) const {
    return V(-3.0 * D2Q9::w[0]) * work(ux, uy);
  }
  template <int i, class V>
  [[gnu::always_inline]] Halves<V> pair(const V& ux, const V& uy) const {
    const V cf = along<i>(V(x_), V(y_)), cu = along<i>(ux, uy);
    return {V(D2Q9::w[i]) * (V(9.0) * cu * cf - V(3.0) * work(ux, uy)), V(3.0 * D2Q9::w[i]) * cf};
  }
  /// ½(F_a u_b + u_a F_b), the force's part of Q_ab.
  template <class V>
  [[gnu::always_inline]] void add_to(NonEquilibrium<V>& q, const V& ux, const V& uy) const {
    q.xx += V(x_) * ux;
    q.yy += V(y_) * uy;
    q.xy += V(0.5) * (V(x_) * uy + V(y_) * ux);
  }

 private:
  template <class V>
  [[gnu::always_inline]] V work(const V& ux, const V& uy) const {
    return V(x_) * ux + V(y_) * uy;
  }
  double x_, y_;
};

/// Q_ab of a cell, from its second moments: Σ c_a c_b f - rho/3 δ_ab - rho u_a u_b, plus the
/// force's part.
template <class Force, class V>
[[gnu::always_inline]] inline NonEquilibrium<V> non_equilibrium(const V (&f)[D2Q9::Q],
                                                                const V& drho, const V& ux,
                                                                const V& uy, const Force& force) {
  // pairs: (1,2) along x, (3,4) along y, (5,6) the diagonal, (7,8) the other one
  const V a = f[1] + f[2], b = f[3] + f[4], c = f[5] + f[6], d = f[7] + f[8];
  const V rho = drho + V(1.0), third = V(1.0 / 3.0) * drho;
  NonEquilibrium<V> q{a + c + d - third - rho * ux * ux, c - d - rho * ux * uy,
                      b + c + d - third - rho * uy * uy};
  if constexpr (Force::on) force.add_to(q, ux, uy);
  return q;
}

/// Relaxation time of a cell's viscosity with its eddy viscosity.
template <class Turbulence, class Force, class V>
[[gnu::always_inline]] inline V turbulent_tau(const V (&f)[D2Q9::Q], const Moments<V>& m,
                                              const Turbulence& turbulence, const Force& force) {
  const V rho = m.drho + V(1.0), inverse = V(1.0) / rho;
  const V ux = force.momentum_x(m.jx) * inverse, uy = force.momentum_y(m.jy) * inverse;
  return turbulence.tau(non_equilibrium(f, m.drho, ux, uy, force), rho);
}

}  // namespace lbm
