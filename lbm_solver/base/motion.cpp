// SPDX-License-Identifier: GPL-2.0-or-later
#include "lbm_solver/base/motion.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>

namespace lbm {
namespace {

/// Between the lines of a table; a velocity is that of the line to come.
void follow_table(const MotionScene& m, double time, Pose& pose) {
  const auto next = std::upper_bound(m.times.begin(), m.times.end(), time);
  const auto k = static_cast<std::size_t>(next - m.times.begin());  // the line after `time`
  if (k == 0 || k == m.times.size()) {
    const std::size_t end = k == 0 ? 0 : k - 1;
    pose.shift = m.shifts[end];
    pose.angle = m.angles[end];
    return;
  }
  const double span = m.times[k] - m.times[k - 1], part = (time - m.times[k - 1]) / span;
  pose.shift = m.shifts[k - 1] + part * (m.shifts[k] - m.shifts[k - 1]);
  pose.angle = std::lerp(m.angles[k - 1], m.angles[k], part);
  pose.velocity = (m.shifts[k] - m.shifts[k - 1]) / span;
  pose.spin = m.axis * ((m.angles[k] - m.angles[k - 1]) / span);
}

}  // namespace

Pose pose_at(const MotionScene& m, double time) {
  Pose pose;
  pose.pivot = m.about;
  pose.axis = m.axis;
  switch (m.kind) {
    case MotionScene::Kind::Linear:
      pose.shift = time * m.velocity;
      pose.velocity = m.velocity;
      break;
    case MotionScene::Kind::Rotation:
      pose.angle = time * m.angular_velocity;
      pose.spin = m.angular_velocity * m.axis;
      break;
    case MotionScene::Kind::Oscillation: {
      const double w = 2.0 * std::numbers::pi * m.frequency;
      const double sine = std::sin(w * time), cosine = w * std::cos(w * time);
      pose.shift = sine * m.amplitude;
      pose.velocity = cosine * m.amplitude;
      pose.angle = sine * m.angular_amplitude;
      pose.spin = (cosine * m.angular_amplitude) * m.axis;
      break;
    }
    case MotionScene::Kind::Table:
      follow_table(m, time, pose);
      break;
  }
  if (m.surface_only) {
    pose.shift = Vec3();
    pose.angle = 0.0;
  }
  return pose;
}

double largest_speed(const MotionScene& m, double reach, double end) {
  const double w = 2.0 * std::numbers::pi * m.frequency;
  double largest = m.velocity.norm() + std::abs(m.angular_velocity) * reach +
                   w * (m.amplitude.norm() + std::abs(m.angular_amplitude) * reach);
  for (std::size_t k = 1; k < m.times.size() && m.times[k - 1] < end; ++k) {
    const double way =
        (m.shifts[k] - m.shifts[k - 1]).norm() + std::abs(m.angles[k] - m.angles[k - 1]) * reach;
    largest = std::max(largest, way / (m.times[k] - m.times[k - 1]));
  }
  return largest;
}

}  // namespace lbm
