// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <algorithm>
#include <cmath>

#include "lbm_solver/immersed/solid_term.h"

namespace lbm {

/// The odd half of a cell's populations splits into the momentum, one further vector of the same
/// symmetry, the ghost
///   z = Σ c_i ψ_i f_i,   ψ = 1/r along the axes and -r in all other directions,
///   r² = A/(1-A),  A = the part of the momentum that populations along the axes carry,
/// and the rest. With these ψ momentum and ghost are orthonormal: f_i = 3 w_i c_i·(j + ψ_i z) +
/// rest.
template <class L>
struct OddGhost {
  static constexpr double axis_share = 6.0 * L::w[1];
  static constexpr double ratio2 = axis_share / (1.0 - axis_share);
  template <int i>
  static constexpr bool along_axis() {
    return L::c[i][0] * L::c[i][0] + L::c[i][1] * L::c[i][1] + L::c[i][2] * L::c[i][2] == 1;
  }
};

/// Λ of TRT where cells collide by resistance. Between planes at a distance H the flux of a
/// parabola is too large by (Λ - 1/8)·2/3 H G/ν, its values by (Λ - 3/16)·2/3 G/ν. A drag is made
/// of fluxes, and arrays of discs and spheres come out best with 1/10.
inline constexpr double kResistanceMagic = 0.1;

/// How fast a covered cell exchanges its odd half with the solid. Of momentum w (against the
/// solid's) and ghost z a step takes
///   Δw = -(momentum w + cross z),   Δz = -(cross w + ghost z),   Δrest = -others rest
template <class V>
struct OddExchange {
  V momentum, cross, ghost, others;
};

/// The exchange of a cell that a solid covers in part (lbm_solver/docs/resistance.md derives it).
/// Written with the values half-way through the collision, m = f + n/2, the solid pulls with a
/// symmetric resistance: -n/Λ⁺ = N⁻¹ (m - m_s), Λ⁺ = τ - 1/2, where for ghosts and momentum
///   N = | ¾ t²/ε - ⅜ μ   -⅜ μ/r      |,   t = 1 - ε,
///       | -⅜ μ/r          ⅜ (t - μ/2) |
/// and ⅜ (t - μ/2) for the rest. Then shear flow along a plane sees it where it is, at every ε and
/// every τ, and flow under a pressure gradient does so as at a half-way wall. Two conditions bind
/// μ(ε): N is positive, and at ε → 0 the rest relaxes as in fluid, so μ(0) = 2 - 16 Λ/3. It falls
/// with t³, with which planes of other directions lie nearest to where they are.
/// @param eps     solid fraction, 0..1; at 1 all of the odd half is reflected about the solid
/// @param s       τ - 1/2
/// @param mu_zero μ(0)
template <class L, class V>
[[gnu::always_inline]] inline OddExchange<V> surface_exchange(const V& eps, const V& s,
                                                              const V& mu_zero) {
  const V t = V(1.0) - eps, t2 = t * t, mu = mu_zero * (t2 * t);
  // rows of s/2 + N, the first one times ε so that nothing is infinite at ε = 0
  const V first = V(0.5) * s * eps + V(0.75) * t2 - V(0.375) * mu * eps;
  const V second = V(0.5) * s + V(0.375) * t - V(0.1875) * mu;
  const V side = V(0.375 / std::sqrt(OddGhost<L>::ratio2)) * mu;  // minus the cross element
  const V part = s / (first * second - eps * side * side);
  return {part * eps * second, part * eps * side, part * first, s / second};
}

/// What the cells of a moving body that are covered whole do ("layered_resistance"): the layer
/// below the surface reflects the odd half about the solid, as a wall does, but for a small
/// mobility that ends its ringing, the same at every τ; deeper cells are the solid's equilibrium.
struct ShellExchange {
  static constexpr double momentum_mobility = 0.005;  ///< of the odd half, as in N
  static constexpr double even_mobility = 0.015;      ///< even_rate = that / Λ⁺
  double momentum, even_rate;
  /// @param s  τ - 1/2
  explicit ShellExchange(double s)
      : momentum(std::max(1.0, 1.0 / (0.5 + momentum_mobility / s))),
        even_rate(std::min(1.0, even_mobility / s)) {}
};

/// How much of the last step's load is in a load. A cell that reflects takes the momentum n = -K w,
/// K up to 2, of which it keeps (1 - K) w until the next step: what the solid got from the flow is
/// the change of what it and the cells it covers hold, F_k + (K-1)/K (F_{k-1} - F_k). Where K = 2
/// it is the mean of two steps, which does not ring. 0 for terms whose whole cells take K = 1.
double load_lag(SolidTerm solid_term, double tau);

/// Collision of a covered cell by resistance: TRT, in which the solid pulls the odd half towards
/// its own velocity, while the even half relaxes as in fluid. Every coefficient of a cell at the
/// surface is Λ⁺ times a function of ε and Λ, so slow steady flow does not depend on τ at all.
/// The momentum that the pull takes from the cell is the force on the solid; a body force acts on
/// the whole cell, as a pressure gradient would.
class ResistanceCollision {
 public:
  /// @param term       by resistance
  /// @param parameters relaxation time and Λ of TRT
  ResistanceCollision(SolidTerm term, const CollisionParameters& parameters);

  /// @param f        populations [q] that arrived; overwritten
  /// @param collide  TRT of pure fluid
  /// @return the force on the solid, lattice units
  template <class L, class V, class Collision>
  [[gnu::always_inline]] Vector<L, V> apply(V (&f)[L::Q], const Collision& collide,
                                            const CoveredCell<L, V>& cell) const {
    const Moments<L, V> m = moments<L>(f);
    const V rho = m.drho + V(1.0);
    const V eps = fraction_of(cell.cover);
    V s(tau_ - 0.5), rate(rate_);
    if constexpr (Collision::local_viscosity) {
      const V tau = collide.relaxation_time(f, m, V(1.0) - eps, cell.eddies);
      s = tau - V(0.5);
      rate = V(1.0) / tau;
    }
    const auto kind = kinds_of(cell.cover);
    const auto whole = eps >= V(kWhole);
    OddExchange<V> odd = surface_exchange<L, V>(eps, s, V(mu_zero_));
    odd.momentum = select(whole, momentum_(kind), odd.momentum);
    odd.cross = select(whole, V(0.0), odd.cross);
    odd.ghost = select(whole, ghost_(kind), odd.ghost);
    odd.others = select(whole, ghost_(kind), odd.others);

    Vector<L, V> force, all, other, half_way;  // all: along the axes; other: in other directions
    unroll<L::D>([&](auto a) __attribute__((always_inline)) {
      constexpr double r2 = OddGhost<L>::ratio2;
      constexpr int axis = 2 * a + 1;
      V driven = m.j[a];
      if constexpr (Collision::forced) driven += V(0.5 * collide.force()[a]);
      const V w = driven - rho * cell.us[a];
      const V along_axis = f[axis] - f[axis + 1], across = m.j[a] - along_axis;
      // the ghost times r, so that no root is left in its ψ: 1 and -r²
      const V z = along_axis - V(r2) * across;
      const V cross = odd.cross * V(1.0 / std::sqrt(r2));
      force[a] = odd.momentum * w + cross * z;
      V p = odd.others * m.j[a] - force[a];
      if constexpr (Collision::forced) p += V(collide.force()[a]);
      const V q = (odd.others - odd.ghost) * z * V(1.0 / r2) - cross * w;
      all[a] = p + q;
      other[a] = p - V(r2) * q;
      // the equilibrium of whole cells is that of what arrived, as in Noble and Torczynski's
      half_way[a] = select(whole, m.j[a], driven - V(0.5) * force[a]);
    });

    const V even_rate = select(whole, even_(kind), rate);
    const V at_fluid = select(whole, even_at_fluid_(kind), even_rate);
    const V at_solid = select(whole, even_at_solid_(kind), V(0.0));
    const V inverse = V(1.0) / rho;
    Vector<L, V> u;
    unroll<L::D>([&](auto a) __attribute__((always_inline)) { u[a] = half_way[a] * inverse; });
    const TwoEquilibria<L, V> eq({m.drho, half_way}, u, cell.us, {at_fluid, at_solid},
                                 {V(0.0), V(0.0)});
    const V kept = V(1.0) - even_rate, odd_kept = V(1.0) - odd.others;
    V source(0.0);
    if constexpr (Collision::forced) source = select(whole, V(0.0), V(1.0) - V(0.5) * even_rate);
    f[0] = kept * f[0] + eq.rest();
    if constexpr (Collision::forced) f[0] += source * collide.force().rest(u);
    unroll<L::pairs>([&](auto pair) __attribute__((always_inline)) {
      constexpr int i = 2 * pair + 1;
      const Vector<L, V>& vector = OddGhost<L>::template along_axis<i>() ? all : other;
      V even = V(0.5) * kept * (f[i] + f[i + 1]) + eq.template pair<i>().even;
      if constexpr (Collision::forced) even += source * collide.force().template pair<i>(u).even;
      const V half = V(0.5) * odd_kept * (f[i] - f[i + 1]) + V(3.0 * L::w[i]) * along<L, i>(vector);
      f[i] = even + half;
      f[i + 1] = even - half;
    });
    return force;
  }

 private:
  double tau_, rate_, mu_zero_;
  // Of cells covered whole, in a core, in a wall: exchange of momentum and ghosts, what becomes of
  // the even half, 1 - even, and of the equilibria of the fluid's and the solid's velocity.
  LaneChoice momentum_, ghost_, even_, even_at_fluid_, even_at_solid_;
};

}  // namespace lbm
