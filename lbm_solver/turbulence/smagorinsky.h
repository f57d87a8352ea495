// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <experimental/simd>

#include "lbm_solver/collision/parameters.h"

namespace lbm {

/// Second moments of the non-equilibrium populations, Q_ab = Σ c_a c_b (f - f^eq), with the body
/// force's part ½(F_a u_b + u_a F_b) added where there is one.
template <class V>
struct NonEquilibrium {
  V xx, xy, yy;
};

/// No turbulence model: tau is a constant, and nobody computes Q for it.
class Laminar {
 public:
  static constexpr bool on = false;
  explicit Laminar(const CollisionParameters& p) : tau_(p.tau) {}
  template <class V>
  [[gnu::always_inline]] V tau(const NonEquilibrium<V>&, const V&) const {
    return V(tau_);
  }
  double tau() const { return tau_; }

 private:
  double tau_;
};

/// Large-eddy viscosity nu_t = (S_c h)² |S|, |S| = √(2 S_ab S_ab), solved for the total relaxation
/// time (paper A Eqs 23-29 with its misprints corrected):
///   tau* = ½ (tau + √(tau² + 18 S_c² Q̂ / rho)),   Q̂ = √(2 Q_ab Q_ab)
class Smagorinsky {
 public:
  static constexpr bool on = true;
  explicit Smagorinsky(const CollisionParameters& p)
      : tau_(p.tau), factor_(18.0 * p.smagorinsky * p.smagorinsky) {}
  template <class V>
  [[gnu::always_inline]] V tau(const NonEquilibrium<V>& q, const V& rho) const {
    using std::sqrt;
    using std::experimental::sqrt;
    const V size = sqrt(V(2.0) * (q.xx * q.xx + q.yy * q.yy) + V(4.0) * q.xy * q.xy);
    return V(0.5) * (V(tau_) + sqrt(V(tau_ * tau_) + V(factor_) * size / rho));
  }

 private:
  double tau_, factor_;
};

}  // namespace lbm
