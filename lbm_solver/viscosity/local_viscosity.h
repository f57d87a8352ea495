// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <algorithm>
#include <experimental/simd>

#include "lbm_solver/collision/parameters.h"
#include "lbm_solver/collision/tensors.h"
#include "lbm_solver/viscosity/relaxation_table.h"

namespace lbm {

/// A viscosity that depends on the shear rate of the cell. The non-equilibrium stress Q_ab holds
/// the product of shear rate and relaxation time, so that tau is a function of it alone:
///
/// Smagorinsky's large-eddy viscosity nu_t = (S_c h)² |S|, |S| = √(2 S_ab S_ab), has a closed form
/// (paper A Eqs 23-29 with its misprints corrected),
///   tau* = ½ (tau + √(tau² + 18 S_c² Q̂ / rho)),   Q̂ = √(2 Q_ab Q_ab);
/// every other law is looked up in a table over Q̂²/rho² of the part of Q without a trace.
class LocalViscosity {
 public:
  static constexpr bool local = true;
  explicit LocalViscosity(const CollisionParameters& p)
      : tau_(p.tau),
        factor_(18.0 * p.smagorinsky * p.smagorinsky),
        table_(p.viscosity_table.get()),
        covered_table_(p.covered_table ? p.covered_table.get() : table_) {}

  /// Relaxation time of a cell that a solid covers in part. What the solid covers is not sheared:
  /// the stress of the cell is that of its fluid times stress_part, and the law is its mean over
  /// the stresses there (docs/viscosity.md). The closed form of Smagorinsky's model goes without.
  /// @param q      second moments of the non-equilibrium populations
  /// @param fluid  part of the cell that is fluid
  /// @param eddies its share of the eddy viscosity (EddyField)
  template <class L, class V>
  [[gnu::always_inline]] V tau(const Symmetric<L, V>& q, const V& rho, const V& fluid,
                               const V& eddies) const {
    if (!table_) return smagorinsky_tau(q, rho, eddies);
    V rate = tabulated_rate(q, rho * stress_part(fluid), *covered_table_);
    if (covered_table_ != table_)  // cells of a block that no solid covers have the law itself
      where(fluid >= V(1.0), rate) = tabulated_rate(q, rho, *table_);
    return V(1.0) / rate;
  }

  /// Stress of a covered cell over that of its fluid: the fluid's part t; of corners, t < ½, on
  /// average over the directions of planes t (1 - ½ (1 - 2t)²). @param t  0..1
  template <class V>
  [[gnu::always_inline]] static V stress_part(const V& t) {
    using std::max;
    using std::experimental::max;
    const V corner = max(V(0.0), V(1.0) - V(2.0) * t);
    return max(V(kLeastPart), t * (V(1.0) - V(0.5) * corner * corner));
  }

  /// 1/tau
  template <class L, class V>
  [[gnu::always_inline]] V rate(const Symmetric<L, V>& q, const V& rho, const V& eddies) const {
    if (table_) return tabulated_rate(q, rho, *table_);
    return V(1.0) / smagorinsky_tau(q, rho, eddies);
  }

  /// Rates of the even and the odd half. @param odd_rule  one of two_rates.h
  template <class L, class OddRule, class V>
  [[gnu::always_inline]] Halves<V> rates(const Symmetric<L, V>& q, const V& rho, const V& eddies,
                                         const OddRule& odd_rule) const {
    if (table_) {
      const V even = tabulated_rate(q, rho, *table_);
      return {even, odd_rule.odd_rate(even)};
    }
    const V tau = smagorinsky_tau(q, rho, eddies);
    return {V(1.0) / tau, V(1.0) / odd_rule.odd_tau(tau)};
  }

 private:
  static constexpr double kLeastPart = 0.01;  // less of a cell says nothing of its stress
  /// 2 Q_ab Q_ab
  template <class L, class V>
  [[gnu::always_inline]] static V squares(const Symmetric<L, V>& q) {
    V sum(0.0);
    Symmetric<L, V>::each_pair([&](auto a, auto b) __attribute__((always_inline)) {
      const V& part = q.template get<a, b>();
      sum += V(a == b ? 2.0 : 4.0) * part * part;
    });
    return sum;
  }

  template <class L, class V>
  [[gnu::always_inline]] static V tabulated_rate(const Symmetric<L, V>& q, const V& rho,
                                                 const RelaxationTable& table) {
    const V trace = q.trace(), inverse = V(1.0) / rho;  // which the velocity needed, too
    return table((squares(q) - V(2.0 / L::D) * trace * trace) * (inverse * inverse));
  }

  template <class L, class V>
  [[gnu::always_inline]] V smagorinsky_tau(const Symmetric<L, V>& q, const V& rho,
                                           const V& eddies) const {
    using std::sqrt;
    using std::experimental::sqrt;
    return V(0.5) * (V(tau_) + sqrt(V(tau_ * tau_) + V(factor_) * eddies * sqrt(squares(q)) / rho));
  }

  double tau_, factor_;
  const RelaxationTable* table_;  // of the parameters; null: Smagorinsky's closed form
  const RelaxationTable* covered_table_;
};

}  // namespace lbm
