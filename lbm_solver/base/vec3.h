// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <Eigen/Core>
#include <array>

namespace lbm {

/// A place, velocity or force. Scenes in two dimensions leave z at 0.
class Vec3 : public Eigen::Vector3d {
 public:
  Vec3() : Eigen::Vector3d(0.0, 0.0, 0.0) {}
  Vec3(double x, double y, double z = 0.0) : Eigen::Vector3d(x, y, z) {}
  template <class Derived>
  Vec3(const Eigen::MatrixBase<Derived>& v) : Eigen::Vector3d(v) {}  // NOLINT: any expression
  template <class Derived>
  Vec3& operator=(const Eigen::MatrixBase<Derived>& v) {
    Eigen::Vector3d::operator=(v);
    return *this;
  }
};

/// Cells along x, y, z or the place of one.
using Cell3 = std::array<int, 3>;

}  // namespace lbm
