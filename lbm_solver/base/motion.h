// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <vector>

#include "lbm_solver/base/pose.h"

namespace lbm {

/// How an obstacle moves, in SI units: a function of time alone, that is 0 where it is at its place
/// in the scene.
struct MotionScene {
  enum class Kind { Linear, Rotation, Oscillation, Table };
  Kind kind = Kind::Linear;
  bool surface_only = false;      ///< it stays where it is, and its surface has the velocity
  Vec3 about;                     ///< pivot at rest [m]: turns about it, and its torque is about it
  Vec3 axis{0, 0, 1};             ///< of length 1
  Vec3 velocity;                  ///< linear [m/s]
  double angular_velocity = 0.0;  ///< rotation [rad/s]
  Vec3 amplitude;                 ///< oscillation: shift = amplitude × sin(2π f t) [m]
  double angular_amplitude = 0;   ///< … and angle likewise [rad]
  double frequency = 0.0;         ///< f [Hz]
  std::vector<double> times;      ///< of a table [s], between which shift and angle are linear
  std::vector<Vec3> shifts;       ///< [m]
  std::vector<double> angles;     ///< [rad]
};

/// @param time  [s]; beyond the ends of a table it stays where they are
Pose pose_at(const MotionScene& motion, double time);

/// Largest speed of a solid [m/s] until a time. @param reach  of it from the axis [m]
double largest_speed(const MotionScene& motion, double reach, double end);

}  // namespace lbm
