// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include "lbm_solver/base/choices.h"
#include "lbm_solver/base/simd.h"
#include "lbm_solver/collision/equilibrium.h"
#include "lbm_solver/collision/forcing.h"
#include "lbm_solver/collision/moments.h"
#include "lbm_solver/immersed/cover_block.h"
#include "lbm_solver/immersed/weight.h"

namespace lbm {

/// The collision Ω^s that drives a covered cell towards the solid's velocity u_s. Every term in use
/// is linear in the populations and in the equilibria of the fluid's and of the solid's velocity,
/// so it is a row of numbers, one triple for each half of a pair:
///   Ω^s± = f_part f± + fluid_part f±^eq(rho, u) + solid_part f±^eq(rho, u_s)
/// The even parts add up to zero (mass), the odd ones too: Σ c_i Ω_i^s = k rho (u_s - u) with
/// k = odd.solid_part.
struct SolidTermRows {
  struct Parts {
    double f, fluid, solid;
  };
  struct Halves {
    Parts even, odd;
  };
  /// A cell that the solid covers in part, one that it covers whole, one in its core, more than two
  /// cells below the surface, and one of a wall or block at rest: full bounce-back in every term.
  Halves surface, whole, core, wall;
};

/// The rows of a term. The two by resistance have none for cells at the surface: their collision
/// (ResistanceCollision) is not linear in a weight.
/// @param term  not SolidTerm::None @param tau  relaxation time of the viscosity
SolidTermRows solid_term_rows(SolidTerm term, double tau);
/// Whether a term's cells collide by resistance. Those need TRT.
bool by_resistance(SolidTerm term);

/// What the cover map knows of a cell.
template <class L, class V>
struct CoveredCell {
  V cover;            ///< as in CoverBlock
  Vector<L, V> us;    ///< solid velocity at the cell centre, lattice units
  V eddies = V(1.0);  ///< share of the eddy viscosity (EddyField)
};

/// f_i^eq(rho, u) times one factor plus f_i^eq(rho, u_s) times another, as halves of pairs, for the
/// cost of about one equilibrium: only the second moments a u u + b u_s u_s and the momenta differ.
template <class L, class V>
class TwoEquilibria {
 public:
  struct Factors {
    V fluid, solid;
  };
  [[gnu::always_inline]] TwoEquilibria(const Moments<L, V>& m, const Vector<L, V>& u,
                                       const Vector<L, V>& us, const Factors& even,
                                       const Factors& odd) {
    const V rho = m.drho + V(1.0), even_solid = rho * even.solid, odd_solid = rho * odd.solid;
    Symmetric<L, V>::each_pair([&](auto k, auto l) __attribute__((always_inline)) {
      stress_.template get<k, l>() = even.fluid * m.j[k] * u[l] + even_solid * us[k] * us[l];
    });
    base_ = (even.fluid + even.solid) * m.drho - V(1.5) * stress_.trace();
    unroll<L::D>([&](auto k) __attribute__((always_inline)) {
      j_[k] = odd.fluid * m.j[k] + odd_solid * us[k];
    });
  }

  [[gnu::always_inline]] V rest() const { return V(L::w[0]) * base_; }

  template <int i>
  [[gnu::always_inline]] lbm::Halves<V> pair() const {
    return {V(L::w[i]) * base_ + V(4.5 * L::w[i]) * stress_.template along<i>(),
            V(3.0 * L::w[i]) * along<L, i>(j_)};
  }

 private:
  Symmetric<L, V> stress_;
  V base_;
  Vector<L, V> j_;
};

/// Immersed-moving-boundary collision of a covered cell, of the fluid's part and of the solid's:
///   f_i <- (1-B) (f_i + Ω_i) + B (f_i + Ω_i^s)
/// with Ω of any collision operator. The force on the solid is the momentum that the cell loses to
/// Ω^s,
///   F = -B Σ c_i Ω_i^s = k B rho (u - u_s),   rho u = j without any body force,
/// an identity that holds to round-off, so no sum over directions is needed. A body force G acts on
/// the fluid's part only; the solid's part, B G, is a force on the solid, as if a pressure gradient
/// drove the fluid.
///
/// Where Ω relaxes with constant rates ω, the fluid's part is made of the same rows as Ω^s,
///   f± + Ω± = (1-ω±) f± + ω± f±^eq(rho, u),
/// and both parts become one row of factors, each linear in B. Any other operator collides for
/// itself.
class CoveredCollision {
 public:
  /// @param collide  the operator of pure fluid
  template <class Collision>
  CoveredCollision(const SolidTermRows& rows, const ImmersedWeight& weight,
                   const Collision& collide)
      : weight_(weight) {
    if constexpr (Collision::constant_rates) {
      even_ = factors(rows, &SolidTermRows::Halves::even,
                      {1.0 - collide.even_rate(), collide.even_rate(), 0.0});
      odd_ = factors(rows, &SolidTermRows::Halves::odd,
                     {1.0 - collide.odd_rate(), collide.odd_rate(), 0.0});
    } else {
      even_ = factors(rows, &SolidTermRows::Halves::even, {0.0, 0.0, 0.0});
      odd_ = factors(rows, &SolidTermRows::Halves::odd, {0.0, 0.0, 0.0});
    }
  }

  /// @param f        populations [q] that arrived; overwritten
  /// @param collide  the operator of pure fluid
  /// @return the force on the solid, lattice units
  template <class L, class V, class Collision>
  [[gnu::always_inline]] Vector<L, V> apply(V (&f)[L::Q], const Collision& collide,
                                            const CoveredCell<L, V>& cell) const {
    const Moments<L, V> m = moments<L>(f);
    const Vector<L, V> u = velocity<L>(m, NoForce<L>({}));
    V s(weight_.tau - 0.5);
    const V eps = fraction_of(cell.cover);
    if constexpr (Collision::local_viscosity)
      s = collide.relaxation_time(f, m, V(1.0) - eps, cell.eddies) - V(0.5);
    const V weight = weight_(eps, s);
    const auto kind = kinds_of(cell.cover);
    const auto of = [&](const Factor& factor) __attribute__((always_inline)) {
      return V(factor.fluid) + weight * factor.solid_less_fluid(kind);
    };
    const V odd_solid = of(odd_.at_solid);
    const V even_f = of(even_.f), odd_f = of(odd_.f);
    const TwoEquilibria<L, V> eq(m, u, cell.us, {of(even_.at_fluid), of(even_.at_solid)},
                                 {of(odd_.at_fluid), odd_solid});
    V fluid[L::Q];
    if constexpr (!Collision::constant_rates) {
      unroll<L::Q>([&](auto q) __attribute__((always_inline)) { fluid[q] = f[q]; });
      collide(fluid, cell.eddies);
    }
    f[0] = even_f * (f[0] + f[0]) + eq.rest();
    unroll<L::pairs>([&](auto p) __attribute__((always_inline)) {
      constexpr int i = 2 * p + 1;
      const lbm::Halves<V> e = eq.template pair<i>();
      const V even = even_f * (f[i] + f[i + 1]) + e.even;
      const V odd = odd_f * (f[i] - f[i + 1]) + e.odd;
      f[i] = even + odd;
      f[i + 1] = even - odd;
    });
    if constexpr (!Collision::constant_rates) {
      const V rest = V(1.0) - weight;
      unroll<L::Q>([&](auto q) __attribute__((always_inline)) { f[q] += rest * fluid[q]; });
    }
    const V strength = odd_solid * (m.drho + V(1.0));
    Vector<L, V> force;
    unroll<L::D>([&](auto a) __attribute__((always_inline)) {
      force[a] = strength * (u[a] - cell.us[a]);
      if constexpr (Collision::forced) force[a] += weight * V(collide.force()[a]);
    });
    return force;
  }

 private:
  /// (1-B) fluid + B solid
  struct Factor {
    double fluid = 0.0;
    LaneChoice solid_less_fluid;  ///< of a cell at the surface, covered whole, in the core, a wall
  };
  /// Of a sum of two opposite populations or their difference, and of the equilibria's halves.
  struct Factors {
    Factor f, at_fluid, at_solid;
  };

  /// @param own  what the fluid's collision makes of each
  static Factors factors(const SolidTermRows& rows,
                         SolidTermRows::Parts SolidTermRows::Halves::*half,
                         const SolidTermRows::Parts& own);

  ImmersedWeight weight_;
  Factors even_, odd_;
};

}  // namespace lbm
