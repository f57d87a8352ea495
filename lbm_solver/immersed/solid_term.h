// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <experimental/simd>
#include <string>
#include <vector>

#include "lbm_solver/collision/equilibrium.h"
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
template <class V>
class TwoEquilibria {
 public:
  struct Factors {
    V fluid, solid;
  };
  [[gnu::always_inline]] TwoEquilibria(const V& drho, const V& ux, const V& uy, const V& us,
                                       const V& vs, const Factors& even, const Factors& odd) {
    const V rho = drho + V(1.0);
    const V a = rho * even.fluid, b = rho * even.solid;
    xx_ = a * ux * ux + b * us * us;
    yy_ = a * uy * uy + b * vs * vs;
    xy_ = a * ux * uy + b * us * vs;
    base_ = (even.fluid + even.solid) * drho - V(1.5) * (xx_ + yy_);
    jx_ = rho * (odd.fluid * ux + odd.solid * us);
    jy_ = rho * (odd.fluid * uy + odd.solid * vs);
  }

  [[gnu::always_inline]] V rest() const { return V(D2Q9::w[0]) * base_; }

  template <int i>
  [[gnu::always_inline]] lbm::Halves<V> pair() const {
    V stress;
    if constexpr (D2Q9::c[i][1] == 0)
      stress = xx_;
    else if constexpr (D2Q9::c[i][0] == 0)
      stress = yy_;
    else
      stress = xx_ + yy_ + V(2.0 * D2Q9::c[i][0] * D2Q9::c[i][1]) * xy_;
    return {V(D2Q9::w[i]) * (base_ + V(4.5) * stress), V(3.0 * D2Q9::w[i]) * along<i>(jx_, jy_)};
  }

 private:
  V xx_, yy_, xy_, base_, jx_, jy_;
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
  CoveredCollision(const SolidTerm& term, WeightRule rule)
      : term_(term), resistance_(rule == WeightRule::Viscous ? 1.0 : 0.0) {}

  template <class V>
  struct Force {
    V x, y;  ///< on the solid, lattice units
  };

  /// What the cover map knows of a cell.
  template <class V>
  struct Cell {
    V weight;  ///< B; the solid fraction where the viscosity differs from cell to cell
    V layer;   ///< 1 surface, 0 whole, -1 core
    V us, vs;  ///< solid velocity at the cell centre, lattice units
  };

  /// @param f        populations [q] that arrived; overwritten
  /// @param collide  the operator of pure fluid
  template <class V, class Collision>
  [[gnu::always_inline]] Force<V> apply(V (&f)[D2Q9::Q], const Collision& collide,
                                        const Cell<V>& cell) const {
    const Moments<V> m = moments(f);
    const V rho = m.drho + V(1.0), inverse = V(1.0) / rho;
    const V ux = m.jx * inverse, uy = m.jy * inverse;
    V weight = cell.weight;
    if constexpr (Collision::turbulent) {
      const V s = collide.relaxation_time(f, m) - V(0.5);
      weight = weight * s / (V(resistance_) * (V(1.0) - weight) + s);
    }
    const auto surface = cell.layer > V(0.5), core = cell.layer < V(-0.5);
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
    typename TwoEquilibria<V>::Factors even{pick(&Part::fluid, &Half::even),
                                            pick(&Part::solid, &Half::even)};
    typename TwoEquilibria<V>::Factors odd{pick(&Part::fluid, &Half::odd),
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
      const TwoEquilibria<V> eq(m.drho, ux, uy, cell.us, cell.vs, even, odd);
      f[0] += even_f * f[0] + eq.rest();
      unroll<D2Q9::pairs>([&](auto p) __attribute__((always_inline)) {
        constexpr int i = 2 * p + 1;
        const lbm::Halves<V> e = eq.template pair<i>();
        const V even_gain = even_f * (V(0.5) * (f[i] + f[i + 1])) + e.even;
        const V odd_gain = odd_f * (V(0.5) * (f[i] - f[i + 1])) + e.odd;
        f[i] += even_gain + odd_gain;
        f[i + 1] += even_gain - odd_gain;
      });
    } else {
      V fluid[D2Q9::Q];
      unroll<D2Q9::Q>([&](auto q) __attribute__((always_inline)) { fluid[q] = f[q]; });
      collide(fluid);
      even_f += weight;
      odd_f += weight;
      const V rest = V(1.0) - weight;
      const TwoEquilibria<V> eq(m.drho, ux, uy, cell.us, cell.vs, even, odd);
      f[0] = rest * fluid[0] + even_f * f[0] + eq.rest();
      unroll<D2Q9::pairs>([&](auto p) __attribute__((always_inline)) {
        constexpr int i = 2 * p + 1;
        const lbm::Halves<V> e = eq.template pair<i>();
        const V even_part = even_f * (V(0.5) * (f[i] + f[i + 1])) + e.even;
        const V odd_part = odd_f * (V(0.5) * (f[i] - f[i + 1])) + e.odd;
        f[i] = rest * fluid[i] + even_part + odd_part;
        f[i + 1] = rest * fluid[i + 1] + even_part - odd_part;
      });
    }
    Force<V> force{strength * (ux - cell.us), strength * (uy - cell.vs)};
    if constexpr (Collision::forced) {
      force.x += weight * V(collide.force().x());
      force.y += weight * V(collide.force().y());
    }
    return force;
  }

 private:
  SolidTerm term_;
  double resistance_;  // of the fluid part of a cell: 1 in B(ε,τ), 0 where B = ε
};

}  // namespace lbm
