// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "lbm_solver/base/vec3.h"
#include "lbm_solver/immersed/body.h"
#include "protocol/wire/messages.h"

namespace lbm {

inline Vec3 to_vec3(const protocol::Vec3& v) {
  return {v[0], v[1], v[2]};
}

/// Velocities, or their change in an interval, SI units.
struct Velocities {
  protocol::Vec3 v{}, omega{};
};

/// What is kept of a carrier from one interval to the next.
struct Past {
  std::int64_t id = 0, epoch = 0;
  Velocities motion;
  protocol::Vec3 force{}, torque{};  ///< as sent, whole where virtual masses are about
  Velocities mean_change;            ///< of the last intervals (LightRule)
};

/// What covers cells for a carrier: a disc or sphere that stands firm in its frame.
struct Sphere {
  std::size_t particle = 0;  ///< on the wire
  std::size_t carrier = 0;   ///< whose it is
  double radius = 0.0;       ///< that the lattice sees [m]
  Vec3 arm;                  ///< from the carrier's centre when the interval began [m]
};

/// Where the fluid that a clump covers lies about its centre, and how its mass is spread.
struct InnerShape {
  Vec3 centroid;                     ///< [m]; 0 where the clump's centre is that of its volume
  Eigen::Matrix3d inertia_per_mass;  ///< about the centre [m²]
};

/// The fluid in a carrier's place.
struct DisplacedFluid {
  double covered = 0.0;              ///< m_c: in covered cells [kg]
  double displaced = 0.0;            ///< m_d: in the place of the whole body [kg]
  double gyration2 = 0.0;            ///< I_c / m_c, of a clump its mean over the axes [m²]
  std::optional<InnerShape> uneven;  ///< of a clump
};

/// A rigid body with mass, inertia, displaced volume and motion: a grain, which has one sphere, or
/// a clump, which may have many. The load that it feels is about its centre.
struct Carrier {
  std::size_t particle = 0;  ///< on the wire
  bool home = true;          ///< its centre is this rank's
  DisplacedFluid inside;
  Velocities change;           ///< of velocities since the interval before; 0 for a new one
  Velocities mean_change;      ///< of the last intervals (LightRule)
  const Past* past = nullptr;  ///< null for a new one
  BodyLoad sum;                ///< of the steps of the interval, lattice units
};

}  // namespace lbm
