// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <Eigen/Core>

#include "lbm_solver/base/triangle_mesh.h"

namespace lbm {

/// ∫ dV, ∫ x dV and ∫ x xᵀ dV of what fills a solid, against a place.
struct MassMoments {
  double volume = 0.0;
  Vec3 first;
  Eigen::Matrix3d second = Eigen::Matrix3d::Zero();
};

/// Of what a closed surface encloses.
MassMoments moments_in(const TriangleMesh& mesh, const Vec3& about);
/// Of a disc of thickness 1 in the plane of x and y, or of a sphere.
MassMoments moments_in_ball(const Vec3& centre, double radius, int dimension, const Vec3& about);

}  // namespace lbm
