// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include "lbm_solver/collision/forcing.h"

namespace lbm {

/// Recursive regularised collision [Malaspinas2015, Coreixas2017]: the populations are rebuilt from
/// rho, u and Q alone, with Hermite terms up to the fourth order, whose non-equilibrium parts
/// follow from the second order's:
///   f_i = f_i^eq4 + (1 - 1/τ) f_i^(1) + S_i / 2,
///   a_xxy = u_y Q_xx + 2 u_x Q_xy,  a_xyy = u_x Q_yy + 2 u_y Q_xy,
///   a_xxyy = u_x² Q_yy + u_y² Q_xx + 4 u_x u_y Q_xy
template <class Turbulence, class Force>
class RecursiveRegularised {
 public:
  static constexpr bool constant_rates = false;  ///< see TwoRates
  explicit RecursiveRegularised(const CollisionParameters& p) : turbulence_(p), force_(p) {}

  static constexpr bool turbulent = Turbulence::on, forced = Force::on;
  const Force& force() const { return force_; }
  template <class V>
  [[gnu::always_inline]] V relaxation_time(const V (&f)[D2Q9::Q], const Moments<V>& m) const {
    return turbulent_tau(f, m, turbulence_, force_);
  }

  template <class V>
  [[gnu::always_inline]] void operator()(V (&f)[D2Q9::Q]) const {
    const Moments<V> m = moments(f);
    const V rho = m.drho + V(1.0), inverse = V(1.0) / rho;
    const V ux = force_.momentum_x(m.jx) * inverse, uy = force_.momentum_y(m.jy) * inverse;
    const NonEquilibrium<V> q = non_equilibrium(f, m.drho, ux, uy, force_);
    const V keep = V(1.0) - V(1.0) / turbulence_.tau(q, rho);
    // coefficients of the Hermite polynomials of order 2, 3 and 4: equilibrium plus what is kept
    const V xx = rho * ux * ux + keep * q.xx, yy = rho * uy * uy + keep * q.yy;
    const V xy = rho * ux * uy + keep * q.xy;
    const V xxy = rho * ux * ux * uy + keep * (uy * q.xx + V(2.0) * ux * q.xy);
    const V xyy = rho * ux * uy * uy + keep * (ux * q.yy + V(2.0) * uy * q.xy);
    const V xxyy = rho * ux * ux * uy * uy +
                   keep * (ux * ux * q.yy + uy * uy * q.xx + V(4.0) * ux * uy * q.xy);
    const V jx = rho * ux, jy = rho * uy;

    f[0] = V(D2Q9::w[0]) * (m.drho - V(1.5) * (xx + yy) + V(2.25) * xxyy);
    if constexpr (Force::on) f[0] += V(0.5) * force_.rest(ux, uy);
    unroll<D2Q9::pairs>([&](auto p) __attribute__((always_inline)) {
      constexpr int i = 2 * p + 1;
      constexpr double cx = D2Q9::c[i][0], cy = D2Q9::c[i][1];
      constexpr double hx = cx * cx - 1.0 / 3, hy = cy * cy - 1.0 / 3;  // Hermite, order 2
      V even = V(D2Q9::w[i]) * (m.drho + V(4.5 * hx) * xx + V(4.5 * hy) * yy +
                                V(9.0 * cx * cy) * xy + V(20.25 * hx * hy) * xxyy);
      V odd = V(D2Q9::w[i]) *
              (V(3.0) * along<i>(jx, jy) + V(13.5 * hx * cy) * xxy + V(13.5 * hy * cx) * xyy);
      if constexpr (Force::on) {
        const auto s = force_.template pair<i>(ux, uy);
        even += V(0.5) * s.even;
        odd += V(0.5) * s.odd;
      }
      f[i] = even + odd;
      f[i + 1] = even - odd;
    });
  }

 private:
  Turbulence turbulence_;
  Force force_;
};

}  // namespace lbm
