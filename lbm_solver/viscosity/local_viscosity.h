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
  /// the stress of the cell is a part of that of its fluid (fluid_squares), and the law is its mean
  /// over the stresses there (docs/viscosity.md). Smagorinsky's closed form has no such
  /// correction.
  /// @param q      second moments of the non-equilibrium populations
  /// @param fluid  part of the cell that is fluid
  /// @param eddies its share of the eddy viscosity (EddyField)
  template <class L, class V>
  [[gnu::always_inline]] V tau(const Symmetric<L, V>& q, const V& rho, const V& fluid,
                               const V& eddies) const {
    if (!table_) return smagorinsky_tau(q, rho, eddies);
    const V inverse = V(1.0) / rho;
    V rate = (*covered_table_)(squares_in_cover(q, fluid) * (inverse * inverse));
    if (covered_table_ != table_)  // cells of a block that no solid covers have the law itself
      where(fluid >= V(1.0), rate) = tabulated_rate(q, rho, *table_);
    return V(1.0) / rate;
  }

  /// 2 Q_ab Q_ab of the fluid of a covered cell, from Q of the cell without its trace. Along a
  /// plane that is parallel to an axis Q has the fluid's part t of the stress. Beside slanted
  /// planes components on the diagonal and the others have (measured, docs/viscosity.md)
  ///   t (1 - (1-t)⁴),   t (1 + 1/2 w t(1-t) - 7/10 (w + d) max(0, 1-2t)²)
  ///   d = Σ Q_aa² / Q_ab Q_ab,   w = 16 (Q_xy² Q_xz² + Q_xy² Q_yz² + Q_xz² Q_yz²) / (Q_ab Q_ab)²
  /// With φ the angle of the slope, d is sin² 2φ where the flow goes down the slope, and w where it
  /// goes along an edge of it.
  /// @param squares  sum of the squares of the diagonal
  /// @param xy, xz, yz  the squares of the others
  /// @param t           0..1
  template <class V>
  [[gnu::always_inline]] static V fluid_squares(const V& squares, const V& xy, const V& xz,
                                                const V& yz, const V& t) {
    using std::max;
    using std::experimental::max;
    const V others = xy + xz + yz, all = max(squares + V(2.0) * others, V(kNoStress));
    const V down = squares / all, along = V(16.0) * (xy * xz + xy * yz + xz * yz) / (all * all);
    const V solid = V(1.0) - t, corner = max(V(0.0), V(1.0) - V(2.0) * t);
    const V part = max(V(kLeastPart), t * (V(1.0) - (solid * solid) * (solid * solid)));
    const V part_of_others = max(V(kLeastPart), t * (V(1.0) + V(0.5) * along * t * solid -
                                                     V(0.7) * (along + down) * (corner * corner)));
    return V(2.0) * squares / (part * part) + V(4.0) * others / (part_of_others * part_of_others);
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
  static constexpr double kLeastPart = 0.01;   // less of a cell says nothing of its stress
  static constexpr double kNoStress = 1e-100;  // floor of Q_ab Q_ab

  template <class L, class V>
  [[gnu::always_inline]] static V squares_in_cover(const Symmetric<L, V>& q, const V& fluid) {
    const V mean = V(1.0 / L::D) * q.trace();
    V diagonal(0.0), others[3] = {V(0.0), V(0.0), V(0.0)};
    Symmetric<L, V>::each_pair([&](auto a, auto b) __attribute__((always_inline)) {
      const V& part = q.template get<a, b>();
      if constexpr (a == b)
        diagonal += (part - mean) * (part - mean);
      else
        others[a + b - 1] = part * part;
    });
    return fluid_squares(diagonal, others[0], others[1], others[2], fluid);
  }

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
