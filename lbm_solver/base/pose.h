// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <functional>

#include "lbm_solver/base/vec3.h"

namespace lbm {

/// Where a rigid solid is against its place at rest, and how it moves there: turned about an axis
/// through a pivot, then shifted. In the units of whoever asks.
struct Pose {
  Vec3 pivot;           ///< at rest
  Vec3 axis{0, 0, 1};   ///< of length 1
  double angle = 0.0;   ///< [rad]
  Vec3 shift;           ///< of the pivot
  Vec3 velocity, spin;  ///< of the pivot; angular velocity

  Vec3 centre() const { return pivot + shift; }
  /// Where a place of the solid at rest is now.
  Vec3 moved(const Vec3& at_rest) const {
    const Vec3 arm = at_rest - pivot;
    return centre() + (angle == 0.0 ? arm : Vec3(Eigen::AngleAxisd(angle, axis) * arm));
  }
  Vec3 velocity_at(const Vec3& place) const { return velocity + spin.cross(place - centre()); }
};

/// A motion as a function of time alone, in steps: a run that goes on meets the same one.
using PoseInTime = std::function<Pose(std::int64_t)>;

}  // namespace lbm
