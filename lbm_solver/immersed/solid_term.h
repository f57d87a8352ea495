// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <experimental/simd>
#include <string>
#include <vector>

#include "lbm_solver/collision/forcing.h"
#include "lbm_solver/immersed/cover_block.h"
#include "lbm_solver/immersed/weight.h"

namespace lbm {

/// The collision Ω^s that drives a covered cell towards the solid's velocity u_s. Every term in use
/// is linear in the populations and in the equilibria of the fluid's and of the solid's velocity,
/// so it is a row of numbers, one triple for each half of a pair:
///   Ω^s± = f_part f± + fluid_part f±^eq(rho, u) + solid_part f±^eq(rho, u_s)
/// The even parts add up to zero (mass), the odd ones too: Σ c_i Ω_i^s = k rho (u_s - u) with
/// k = odd.solid_part.
struct SolidTerm {
  struct Parts {
    double f, fluid, solid;
  };
  struct Halves {
    Parts even, odd;
  };
  /// A cell that the solid covers in part, one that it covers whole, and one in its core, more than
  /// two cells below the surface.
  Halves surface, whole, core;
};

/// A term by its name. @param tau  relaxation time of the viscosity
/// @throws std::invalid_argument naming the known ones
SolidTerm solid_term(const std::string& name, double tau);
std::vector<std::string> known_solid_terms();

/// f_i^eq(rho, u) times one factor plus f_i^eq(rho, u_s) times another, as halves of pairs, for the
/// cost of about one equilibrium: only the second moments a u u + b u_s u_s and the momenta differ.
template <class L, class V>
class TwoEquilibria {
 public:
  struct Factors {
    V fluid, solid;
  };
  [[gnu::always_inline]] TwoEquilibria(const V& drho, const Vector<L, V>& u, const Vector<L, V>& us,
                                       const Factors& even, const Factors& odd) {
    const V rho = drho + V(1.0);
    const V a = rho * even.fluid, b = rho * even.solid;
    Symmetric<L, V>::each_pair([&](auto k, auto l) __attribute__((always_inline)) {
      stress_.template get<k, l>() = a * u[k] * u[l] + b * us[k] * us[l];
    });
    base_ = (even.fluid + even.solid) * drho - V(1.5) * stress_.trace();
    unroll<L::D>([&](auto k) __attribute__((always_inline)) {
      j_[k] = rho * (odd.fluid * u[k] + odd.solid * us[k]);
    });
  }

  [[gnu::always_inline]] V rest() const { return V(L::w[0]) * base_; }

  template <int i>
  [[gnu::always_inline]] lbm::Halves<V> pair() const {
    return {V(L::w[i]) * (base_ + V(4.5) * stress_.template along<i>()),
            V(3.0 * L::w[i]) * along<L, i>(j_)};
  }

 private:
  Symmetric<L, V> stress_;
  V base_;
  Vector<L, V> j_;
};

/// Immersed-moving-boundary collision of a covered cell:
///   f_i <- f_i + (1-B) Ω_i + B Ω_i^s
/// with Ω of any collision operator. The force on the solid is the momentum that the cell loses to
/// Ω^s,
///   F = -B Σ c_i Ω_i^s = k B rho (u - u_s),   rho u = j without any body force,
/// an identity that holds to round-off, so no sum over directions is needed. A body force G acts on
/// the fluid's part only; the solid's part, B G, is a force on the solid, as if a pressure gradient
/// drove the fluid.
class CoveredCollision {
 public:
  CoveredCollision(const SolidTerm& term, const ImmersedWeight& weight)
      : term_(term), weight_(weight) {}

  /// What the cover map knows of a cell.
  template <class L, class V>
  struct Cell {
    V cover;          ///< as in CoverBlock
    Vector<L, V> us;  ///< solid velocity at the cell centre, lattice units
  };

  /// @param f        populations [q] that arrived; overwritten
  /// @param collide  the operator of pure fluid
  /// @return the force on the solid, lattice units
  template <class L, class V, class Collision>
  [[gnu::always_inline]] Vector<L, V> apply(V (&f)[L::Q], const Collision& collide,
                                            const Cell<L, V>& cell) const {
    const Moments<L, V> m = moments<L>(f);
    const V rho = m.drho + V(1.0);
    const Vector<L, V> u = velocity<L>(m, NoForce<L>({}));
    V tau(weight_.tau);
    if constexpr (Collision::turbulent) tau = collide.relaxation_time(f, m);
    const V weight = weight_(fraction_of(cell.cover), tau);
    const auto surface = cell.cover < V(kWhole), core = cell.cover == V(kCore);
    const auto pick = [&](const double SolidTerm::Parts::*part,
                          const SolidTerm::Parts SolidTerm::Halves::*half)
        __attribute__((always_inline)) {
      V value((term_.whole.*half).*part);
      where(surface, value) = V((term_.surface.*half).*part);
      where(core, value) = V((term_.core.*half).*part);
      return weight * value;
    };
    using Half = SolidTerm::Halves;
    using Part = SolidTerm::Parts;
    V even_f = pick(&Part::f, &Half::even), odd_f = pick(&Part::f, &Half::odd);
    typename TwoEquilibria<L, V>::Factors even{pick(&Part::fluid, &Half::even),
                                               pick(&Part::solid, &Half::even)};
    typename TwoEquilibria<L, V>::Factors odd{pick(&Part::fluid, &Half::odd),
                                              pick(&Part::solid, &Half::odd)};
    const V strength = odd.solid * rho;
    if constexpr (Collision::constant_rates) {
      // The fluid's part is a relaxation too, with (1-B) times its rates.
      const V rest = V(1.0) - weight;
      const V even_rate = rest * V(collide.even_rate()), odd_rate = rest * V(collide.odd_rate());
      even_f -= even_rate;
      even.fluid += even_rate;
      odd_f -= odd_rate;
      odd.fluid += odd_rate;
      const TwoEquilibria<L, V> eq(m.drho, u, cell.us, even, odd);
      f[0] += even_f * f[0] + eq.rest();
      unroll<L::pairs>([&](auto p) __attribute__((always_inline)) {
        constexpr int i = 2 * p + 1;
        const lbm::Halves<V> e = eq.template pair<i>();
        const V even_gain = even_f * (V(0.5) * (f[i] + f[i + 1])) + e.even;
        const V odd_gain = odd_f * (V(0.5) * (f[i] - f[i + 1])) + e.odd;
        f[i] += even_gain + odd_gain;
        f[i + 1] += even_gain - odd_gain;
      });
    } else {
      V fluid[L::Q];
      unroll<L::Q>([&](auto q) __attribute__((always_inline)) { fluid[q] = f[q]; });
      collide(fluid);
      even_f += weight;
      odd_f += weight;
      const V rest = V(1.0) - weight;
      const TwoEquilibria<L, V> eq(m.drho, u, cell.us, even, odd);
      f[0] = rest * fluid[0] + even_f * f[0] + eq.rest();
      unroll<L::pairs>([&](auto p) __attribute__((always_inline)) {
        constexpr int i = 2 * p + 1;
        const lbm::Halves<V> e = eq.template pair<i>();
        const V even_part = even_f * (V(0.5) * (f[i] + f[i + 1])) + e.even;
        const V odd_part = odd_f * (V(0.5) * (f[i] - f[i + 1])) + e.odd;
        f[i] = rest * fluid[i] + even_part + odd_part;
        f[i + 1] = rest * fluid[i + 1] + even_part - odd_part;
      });
    }
    Vector<L, V> force;
    unroll<L::D>([&](auto a) __attribute__((always_inline)) {
      force[a] = strength * (u[a] - cell.us[a]);
      if constexpr (Collision::forced) force[a] += weight * V(collide.force()[a]);
    });
    return force;
  }

 private:
  SolidTerm term_;
  ImmersedWeight weight_;
};

}  // namespace lbm
