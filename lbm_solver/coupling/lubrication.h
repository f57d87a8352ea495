// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <span>
#include <vector>

#include "lbm_solver/immersed/body.h"
#include "lbm_solver/immersed/footprint.h"

namespace lbm {

/// Normal lubrication between particles, and between particles and the box's walls, where the gap
/// is too narrow for the lattice. Two that approach with U_n feel
///   F = ζ(h) U_n,   cylinders, per unit depth: ζ(h) = 3√2 π μ (R*/h)^{3/2},   spheres: 6 π μ
///   R*²/h, R* = R₁R₂/(R₁+R₂)   (a wall: R* = R)
/// [Jeffrey and Onishi 1981, 1984, leading order]. The lattice resolves ζ down to the gap h₀, so
/// ζ(h) - ζ(h₀) is added below it. The force is held for an interval T, so it is the mean of one
/// that decays with the motion, ζ U_n / (1 + ζ T/m*): a pair is never thrown back. Between the
/// spheres of one clump there is none.
struct Lubrication {
  double viscosity = 0.0;  ///< kinematic, lattice units
  double range = 1.0;      ///< h₀ [cells]
  double interval = 1.0;   ///< T [steps]

  /// ζ(h) - ζ(h₀), 0 from h₀ on. @param radius  R* @param gap  h; below 0.001 R* taken as that
  double resistance(double gap, double radius, bool spheres = false) const;

  /// Adds the forces to the loads; where several ranks share the box, those of the gaps whose
  /// middle lies in this one's cells.
  /// @param masses  [body], lattice units; infinity for one that does not move
  void add(std::span<const Body> bodies, std::span<const double> masses, const Domain& domain,
           const Block& cells, std::span<BodyLoad> loads) const;
  void add(std::span<const Body> bodies, std::span<const double> masses, const Domain& domain,
           std::span<BodyLoad> loads) const {
    add(bodies, masses, domain, Block::whole(domain), loads);
  }

 private:
  double force(double gap, double radius, double approach, double mass, bool spheres) const;
  void add_walls(const Body& body, double mass, const Domain& domain, const Block& cells,
                 BodyLoad& load) const;
};

}  // namespace lbm
