// SPDX-License-Identifier: GPL-2.0-or-later
#include "lbm_solver/coupling/motion_words.h"

#include <fmt/core.h>

#include <cmath>
#include <numbers>
#include <stdexcept>

namespace lbm {
namespace {

std::string numbers(const Vec3& v) {
  return fmt::format("{} {} {}", v.x(), v.y(), v.z());
}

std::string about(const MotionScene& m, double sign) {
  return fmt::format("origin {} axis {}", numbers(m.about), numbers(sign * m.axis));
}

}  // namespace

std::string mesh_motion_words(const MotionScene& m) {
  const double w = m.angular_velocity;
  switch (m.kind) {
    case MotionScene::Kind::Linear:
      return fmt::format("{} {}", m.surface_only ? "surface_vel" : "linear", numbers(m.velocity));
    case MotionScene::Kind::Rotation:
      if (m.surface_only) return fmt::format("surface_ang_vel {} omega {}", about(m, 1.0), w);
      return fmt::format("rotate {} period {}", about(m, w > 0.0 ? 1.0 : -1.0),
                         2.0 * std::numbers::pi / std::abs(w));
    case MotionScene::Kind::Oscillation:
      if (m.angular_amplitude == 0.0)
        return fmt::format("wiggle amplitude {} period {}", numbers(m.amplitude),
                           1.0 / m.frequency);
      return fmt::format("riggle {} period {} amplitude {}", about(m, 1.0), 1.0 / m.frequency,
                         m.angular_amplitude * 180.0 / std::numbers::pi);
    case MotionScene::Kind::Table:
      break;
  }
  throw std::logic_error("a motion that no script can follow");
}

std::string disc_wall_words(const ObstacleScene& o, double grain_radius) {
  if (!o.round || !o.motion || o.motion->kind != MotionScene::Kind::Rotation) return {};
  if (o.motion->about != o.centre) return {};
  // Of a cylinder along z LIGGGHTS' shear along x (or y) is its angular velocity [rad/s], and the
  // wall has the speed of a turn at the middle of a grain, not where it touches.
  const double radius = 0.5 * o.diameter, middle = radius + (o.hollow ? -1 : 1) * grain_radius;
  return fmt::format("zcylinder {} {} {} shear x {}", radius, o.centre.x(), o.centre.y(),
                     o.motion->angular_velocity * (middle > 0.0 ? radius / middle : 1.0));
}

}  // namespace lbm
