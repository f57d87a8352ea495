// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <Eigen/Geometry>
#include <cstdint>

#include "lbm_solver/base/vec3.h"

namespace lbm {

/// Angular velocity; a number alone is that of a disc, about z.
class Spin : public Vec3 {
 public:
  Spin() = default;
  Spin(double z) : Vec3(0.0, 0.0, z) {}  // NOLINT: a number stands for it
  Spin(double x, double y, double z) : Vec3(x, y, z) {}
  template <class Derived>
  Spin(const Eigen::MatrixBase<Derived>& v) : Vec3(v) {}  // NOLINT: any expression
};

/// A rigid disc (in two dimensions) or sphere as the lattice sees it, in lattice units. Several
/// that move as one rigid body (a clump) have one carrier: they cover a cell once, and may overlap.
struct Body {
  std::int64_t id = 0;
  Vec3 centre;
  double radius = 0.0;
  Vec3 velocity;
  Spin spin;                 ///< [rad / step]
  bool hollow = false;       ///< the solid is everything outside of the circle or sphere
  std::int32_t carrier = 0;  ///< a number that those of one clump share; 0: a body of its own

  /// Velocity of its material at a place `arm` from its centre.
  Vec3 velocity_at(const Vec3& arm) const { return velocity + spin.cross(arm); }
};

/// Force and torque on a body about its centre, lattice units.
struct BodyLoad {
  Vec3 force, torque;
  /// Adds a force that acts `arm` from the centre.
  void add(const Vec3& f, const Vec3& arm) {
    force += f;
    torque += arm.cross(f);
  }
};

}  // namespace lbm
