// SPDX-License-Identifier: GPL-2.0-or-later
#include "lbm_solver/base/mass_moments.h"

#include <Eigen/Geometry>
#include <numbers>

namespace lbm {

/// Sum over the tetrahedra between `about` and each triangle.
MassMoments moments_in(const TriangleMesh& mesh, const Vec3& about) {
  MassMoments m;
  for (const auto& t : mesh.triangles) {
    const Vec3 a = mesh.vertices[t[0]] - about, b = mesh.vertices[t[1]] - about,
               c = mesh.vertices[t[2]] - about, sum = a + b + c;
    const double six_volumes = a.dot(b.cross(c));
    m.volume += six_volumes / 6.0;
    m.first += six_volumes / 24.0 * sum;
    m.second += six_volumes / 120.0 *
                (sum * sum.transpose() + a * a.transpose() + b * b.transpose() + c * c.transpose());
  }
  return m;
}

MassMoments moments_in_ball(const Vec3& centre, double radius, int dimension, const Vec3& about) {
  const Vec3 arm = centre - about;
  const double square = radius * radius;
  MassMoments m;
  m.volume = std::numbers::pi * square * (dimension == 2 ? 1.0 : 4.0 / 3.0 * radius);
  m.first = m.volume * arm;
  m.second = m.volume * (arm * arm.transpose());
  for (int k = 0; k < dimension; ++k)
    m.second(k, k) += m.volume * square / (dimension == 2 ? 4.0 : 5.0);
  return m;
}

}  // namespace lbm
