// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <experimental/simd>

#include "lbm_solver/collision/equilibrium.h"
#include "lbm_solver/collision/parameters.h"

namespace lbm {

/// No turbulence model: tau is a constant, and nobody computes Q for it.
class Laminar {
 public:
  static constexpr bool on = false;
  explicit Laminar(const CollisionParameters& p) : tau_(p.tau) {}
  template <class L, class V>
  [[gnu::always_inline]] V tau(const Symmetric<L, V>&, const V&) const {
    return V(tau_);
  }

 private:
  double tau_;
};

/// Large-eddy viscosity nu_t = (S_c h)² |S|, |S| = √(2 S_ab S_ab), solved for the total relaxation
/// time (paper A Eqs 23-29 with its misprints corrected):
///   tau* = ½ (tau + √(tau² + 18 S_c² Q̂ / rho)),   Q̂ = √(2 Q_ab Q_ab)
/// with Q_ab the second moments of the non-equilibrium populations.
class Smagorinsky {
 public:
  static constexpr bool on = true;
  explicit Smagorinsky(const CollisionParameters& p)
      : tau_(p.tau), factor_(18.0 * p.smagorinsky * p.smagorinsky) {}
  template <class L, class V>
  [[gnu::always_inline]] V tau(const Symmetric<L, V>& q, const V& rho) const {
    using std::sqrt;
    using std::experimental::sqrt;
    V squares(0.0);
    Symmetric<L, V>::each_pair([&](auto a, auto b) __attribute__((always_inline)) {
      const V& part = q.template get<a, b>();
      squares += V(a == b ? 2.0 : 4.0) * part * part;
    });
    return V(0.5) * (V(tau_) + sqrt(V(tau_ * tau_) + V(factor_) * sqrt(squares) / rho));
  }

 private:
  double tau_, factor_;
};

}  // namespace lbm
