// SPDX-License-Identifier: GPL-2.0-or-later
/// Obstacles that move, to test with.
#pragma once

#include <cmath>
#include <memory>
#include <utility>

#include "lbm_solver/immersed/geometry.h"
#include "lbm_solver/solver/fluid.h"
#include "tests/support/meshes.h"

namespace test {

/// Obstacles that move, all of them over the faces between ranks: a box that turns and goes through
/// the sides of the box, a ball that oscillates, and a drum around both.
inline void add_movers(lbm::Fluid& fluid) {
  using namespace lbm;
  const Domain& d = fluid.domain();
  const bool flat = d.dimension() == 2;
  const Vec3 middle(0.5 * d.nx + 0.2, 0.5 * d.ny - 0.3, flat ? 0.0 : 0.5 * d.nz + 0.1);
  const double low = flat ? -1.0 : 4.2, high = flat ? 2.0 : 8.9;
  const auto solid = [](TriangleMesh mesh) {
    return MeshSolid{std::make_shared<const TriangleMesh>(std::move(mesh)), false};
  };
  fluid.add(solid(box_mesh({1.4, 2.3, low}, {7.1, 8.2, high})), [=](std::int64_t step) {
    Pose pose;
    pose.pivot = {4.0, 5.0, flat ? 0.0 : 6.0};
    pose.axis = flat ? Vec3(0, 0, 1) : Vec3(Vec3(1, 2, 2) / 3.0);
    pose.spin = 0.02 * pose.axis;
    pose.angle = 0.02 * static_cast<double>(step);
    pose.velocity = {-0.06, 0.04, flat ? 0.0 : 0.05};
    pose.shift = static_cast<double>(step) * pose.velocity;
    return pose;
  });
  const TriangleMesh round =
      flat ? cylinder_mesh(middle - Vec3(0, 0, 99), middle + Vec3(0, 0, 99), 3.3, 40)
           : sphere_mesh(middle, 3.3, 1);
  fluid.add(solid(round), [=](std::int64_t step) {
    Pose pose;
    pose.pivot = middle;
    pose.shift = Vec3(1.5 * std::sin(0.05 * static_cast<double>(step)), 0.0, 0.0);
    pose.velocity = Vec3(0.075 * std::cos(0.05 * static_cast<double>(step)), 0.0, 0.0);
    return pose;
  });
  if (!flat) return;
  TriangleMesh inside = cylinder_mesh(middle - Vec3(0, 0, 99), middle + Vec3(0, 0, 99), 8, 80);
  for (auto& [a, b, c] : inside.triangles) std::swap(b, c);
  const TriangleMesh outside =
      cylinder_mesh(middle - Vec3(0, 0, 99), middle + Vec3(0, 0, 99), 10, 80);
  fluid.add(
      solid(together({outside, inside})),
      [=](std::int64_t) {
        Pose pose;
        pose.pivot = middle;
        pose.spin = {0.0, 0.0, 0.004};
        return pose;
      },
      9.0, true);
}

}  // namespace test
