// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include "lbm_solver/collision/forcing.h"

namespace lbm {

/// Central-moment (cascaded) collision [GeierGreinerKorvink2006, DeRosis2016]. The moments
///   κ_ab = Σ (c_x - u_x)^a (c_y - u_y)^b f
/// relax in the frame of the moving fluid: the shear part of the second order with 1/τ, its trace
/// and everything above at once to the Maxwellian's values (κ_22 = rho/9, odd orders 0). A body
/// force is the first moment: -F/2 before, +F/2 after, and its third-order companions F/6.
template <class Turbulence, class Force>
class CentralMoments {
 public:
  static constexpr bool constant_rates = false;  ///< see TwoRates
  explicit CentralMoments(const CollisionParameters& p)
      : turbulence_(p), force_(p), parameters_(p) {}

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
    // Only three of the nine moments survive the collision; Q gives them directly.
    const NonEquilibrium<V> q = non_equilibrium(f, m.drho, ux, uy, force_);
    const V keep = V(1.0) - V(1.0) / turbulence_.tau(q, rho);
    const V shear = V(0.5) * keep * (q.xx - q.yy), cross = keep * q.xy;
    const V fx(0.5 * parameters_.force_x), fy(0.5 * parameters_.force_y);
    const V third(1.0 / 3.0);

    // κ_ab after the collision, b = 0, 1, 2 in turn; transformed back along x, then along y
    V a0 = rho, a1 = half_force(fx), a2 = third * rho + shear;
    V b0 = half_force(fy), b1 = cross, b2 = third * half_force(fy);
    V c0 = third * rho - shear, c1 = third * half_force(fx), c2 = V(1.0 / 9.0) * rho;
    invert(a0, a1, a2, ux);
    invert(b0, b1, b2, ux);
    invert(c0, c1, c2, ux);
    column<-1>(f, a0, b0, c0, uy);
    column<0>(f, a1, b1, c1, uy);
    column<1>(f, a2, b2, c2, uy);
  }

 private:
  template <class V>
  [[gnu::always_inline]] static V half_force(const V& force) {
    return Force::on ? force : V(0.0);
  }

  /// Central moments of one axis, k0 k1 k2, to values at c = -1, 0, 1.
  template <class V>
  [[gnu::always_inline]] static void invert(V& k0, V& k1, V& k2, const V& u) {
    const V first = k1 + u * k0, second = k2 + u * (V(2.0) * k1 + u * k0);
    const V at_rest = k0 - second;
    k0 = V(0.5) * (second - first);
    k2 = V(0.5) * (second + first);
    k1 = at_rest;
  }
  static constexpr int direction(int cx, int cy) {
    for (int i = 0; i < D2Q9::Q; ++i)
      if (D2Q9::c[i][0] == cx && D2Q9::c[i][1] == cy) return i;
    return -1;
  }
  /// Weights on a grid of 2^-54, on which their sum is 1 to the last bit: taken off whole
  /// populations, the nearest doubles (their sum is off by 5e-17) would let the mass drift.
  static constexpr double weight(int i) {
    constexpr auto on_grid = [](double w) {
      constexpr double grid = 18014398509481984.0;
      return static_cast<double>(static_cast<long long>(w * grid + 0.5)) / grid;
    };
    if (i > 0) return on_grid(D2Q9::w[i]);
    return 1.0 - 4.0 * on_grid(1.0 / 9.0) - 4.0 * on_grid(1.0 / 36.0);
  }
  template <int cx, class V>
  [[gnu::always_inline]] static void column(V (&f)[D2Q9::Q], V k0, V k1, V k2, const V& uy) {
    invert(k0, k1, k2, uy);
    constexpr int down = direction(cx, -1), middle = direction(cx, 0), up = direction(cx, 1);
    f[down] = k0 - V(weight(down));
    f[middle] = k1 - V(weight(middle));
    f[up] = k2 - V(weight(up));
  }

  Turbulence turbulence_;
  Force force_;
  CollisionParameters parameters_;
};

}  // namespace lbm
