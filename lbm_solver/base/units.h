// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include "lbm_solver/base/vec3.h"

namespace lbm {

/// The border between SI (scene, wire, files) and lattice units (kernels). In lattice units the
/// cell and the step are 1, the reference density is 1, and cell i of an axis spans [i, i+1].
struct Units {
  double dx = 1.0;       ///< cell [m]
  double dt = 1.0;       ///< fluid step [s]
  double density = 1.0;  ///< reference density of the fluid [kg/m^3]
  double depth = 1.0;    ///< thickness of the layer that forces and masses belong to, in three
                         ///< dimensions the cell [m]
  Vec3 origin;           ///< lower corner of the box [m]

  double velocity() const { return dx / dt; }                ///< 1 lattice unit [m/s]
  double mass() const { return density * dx * dx * depth; }  ///< of a cell [kg]
  double force() const { return mass() * dx / (dt * dt); }   ///< [N]
  double torque() const { return force() * dx; }             ///< [N m]
  double pressure() const {
    return density * velocity() * velocity() / 3.0;
  }  ///< per unit rho [Pa]

  Vec3 to_lattice_position(const Vec3& x) const { return (x - origin) / dx; }
  Vec3 to_lattice_velocity(const Vec3& v) const { return v / velocity(); }
  Vec3 to_lattice_spin(const Vec3& omega) const { return omega * dt; }
};

}  // namespace lbm
