// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include "lbm_solver/collision/forcing.h"
#include "lbm_solver/collision/moment_basis.h"
#include "lbm_solver/collision/moments.h"

namespace lbm {

/// Central-moment (cascaded) collision [GeierGreinerKorvink2006, DeRosis2016]. The moments
///   κ_abc = Σ (c_x - u_x)^a (c_y - u_y)^b (c_z - u_z)^c f
/// relax in the frame of the moving fluid: the deviatoric part of the second order with 1/τ, its
/// trace and everything above at once to the Maxwellian's values (a factor 1/3 for each square,
/// odd orders 0). A body force is the first moment: -F/2 before, +F/2 after, and the same times
/// the Maxwellian's squares of the other axes.
template <class L, class Viscosity, class Force>
class CentralMoments {
 public:
  using Set = L;
  static constexpr bool constant_rates = false, fixed_magic = false;  ///< see TwoRates
  explicit CentralMoments(const CollisionParameters& p) : viscosity_(p), force_(p) {}

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
    // Only rho, u and the stress survive the collision; Q gives the stress directly.
    const Symmetric<L, V> q = non_equilibrium<L>(f, m.drho, u, force_);
    const V keep = V(1.0) - viscosity_.rate(q, rho, eddies);
    Coefficients<L, V> k;
    k.each([&](auto a, auto b, auto c)
               __attribute__((always_inline)) { k.at[a][b][c] = after<a, b, c>(rho, keep, q); });
    unroll<L::D>([&](auto axis) __attribute__((always_inline)) {
      k.template each_line<axis>([&](V & k0, V & k1, V & k2) __attribute__((always_inline)) {
        k2 += u[axis] * (V(2.0) * k1 + u[axis] * k0);  // about the frame at rest
        k1 += u[axis] * k0;
      });
    });
    to_populations<L>(k, f);
    unroll<L::Q>([&](auto i) __attribute__((always_inline)) { f[i] -= V(weight(i)); });
  }

 private:
  /// κ_abc after the collision.
  template <int a, int b, int c, class V>
  [[gnu::always_inline]] V after(const V& rho, const V& keep, const Symmetric<L, V>& q) const {
    constexpr int power[] = {a, b, c};
    constexpr int odd = (a == 1) + (b == 1) + (c == 1), squares = (a == 2) + (b == 2) + (c == 2);
    constexpr double maxwell = squares == 0   ? 1.0
                               : squares == 1 ? 1.0 / 3
                               : squares == 2 ? 1.0 / 9
                                              : 1.0 / 27;
    if constexpr (odd == 0) {
      V value = V(maxwell) * rho;
      if constexpr (squares == 1) {
        constexpr int axis = power[0] == 2 ? 0 : power[1] == 2 ? 1 : 2;
        value += keep * (q.at[axis] - V(1.0 / L::D) * q.trace());
      }
      return value;
    }
    if constexpr (odd == 1 && Force::on) {
      constexpr int axis = power[0] == 1 ? 0 : power[1] == 1 ? 1 : 2;
      return V(0.5 * maxwell * force_[axis]);
    }
    if constexpr (odd == 2 && squares == 0) {
      constexpr int first = a == 1 ? 0 : 1, second = c == 1 ? 2 : 1;
      return keep * q.template get<first, second>();
    }
    return V(0.0);
  }

  /// Weights on a grid of 2^-54, on which their sum is 1 to the last bit: taken off whole
  /// populations, the nearest doubles (their sum is off by 5e-17) would let the mass drift.
  static constexpr double weight(int i) {
    constexpr auto on_grid = [](double w) {
      constexpr double grid = 18014398509481984.0;
      return static_cast<double>(static_cast<long long>(w * grid + 0.5)) / grid;
    };
    if (i > 0) return on_grid(L::w[i]);
    double others = 0.0;
    for (int q = 1; q < L::Q; ++q) others += on_grid(L::w[q]);
    return 1.0 - others;
  }

  Viscosity viscosity_;
  Force force_;
};

}  // namespace lbm
