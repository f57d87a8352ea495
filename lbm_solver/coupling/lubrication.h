// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <span>
#include <vector>

#include "lbm_solver/immersed/disc.h"
#include "lbm_solver/immersed/footprint.h"

namespace lbm {

/// Normal lubrication between discs, and between discs and the box's walls, where the gap is too
/// narrow for the lattice. Two cylinders that approach with U_n feel, per unit depth,
///   F = ζ(h) U_n,   ζ(h) = 3√2 π μ (R*/h)^{3/2},   R* = R₁R₂/(R₁+R₂)   (a wall: R* = R)
/// [Jeffrey and Onishi 1981, leading order]. The lattice resolves ζ down to the gap h₀, so
/// ζ(h) - ζ(h₀) is added below it. The force is held for an interval T, so it is the mean of one
/// that decays with the motion, ζ U_n / (1 + ζ T/m*): a pair is never thrown back.
struct Lubrication {
  double viscosity = 0.0;  ///< kinematic, lattice units
  double range = 1.0;      ///< h₀ [cells]
  double interval = 1.0;   ///< T [steps]

  /// ζ(h) - ζ(h₀), 0 from h₀ on. @param radius  R* @param gap  h; below 0.001 R* taken as that
  double resistance(double gap, double radius) const;

  /// Adds the forces to the loads.
  /// @param masses  [disc], lattice units; infinity for one that does not move
  void add(std::span<const Disc> discs, std::span<const double> masses, const Domain& domain,
           std::span<DiscLoad> loads) const;

 private:
  double force(double gap, double radius, double approach, double mass) const;
  void add_walls(const Disc& disc, double mass, const Domain& domain, DiscLoad& load) const;
};

}  // namespace lbm
