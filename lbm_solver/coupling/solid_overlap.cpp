// SPDX-License-Identifier: GPL-2.0-or-later
#include "lbm_solver/coupling/solid_overlap.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <numbers>

#include "lbm_solver/solver/place_check.h"

namespace lbm {
namespace {

constexpr double kOnSurface = 1e-9;  // of the radius

/// The place of a triangle that is nearest to the origin [Ericson2005].
Vec3 nearest_place(const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 ab = b - a, ac = c - a;
  const double d1 = -ab.dot(a), d2 = -ac.dot(a), d3 = -ab.dot(b), d4 = -ac.dot(b), d5 = -ab.dot(c),
               d6 = -ac.dot(c);
  if (d1 <= 0.0 && d2 <= 0.0) return a;
  if (d3 >= 0.0 && d4 <= d3) return b;
  if (d6 >= 0.0 && d5 <= d6) return c;
  const double of_c = d1 * d4 - d3 * d2, of_b = d5 * d2 - d1 * d6, of_a = d3 * d6 - d5 * d4;
  if (of_c <= 0.0 && d1 >= 0.0 && d3 <= 0.0) return a + d1 / (d1 - d3) * ab;
  if (of_b <= 0.0 && d2 >= 0.0 && d6 <= 0.0) return a + d2 / (d2 - d6) * ac;
  if (of_a <= 0.0 && d4 >= d3 && d5 >= d6) return b + (d4 - d3) / ((d4 - d3) + (d5 - d6)) * (c - b);
  return a + (of_b * ab + of_c * ac) / (of_a + of_b + of_c);
}

/// How far inside of a mesh a place lies [m], negative outside. In two dimensions the ends of a
/// block across the layer are no surface.
double depth_in_mesh(const TriangleMesh& mesh, const Vec3& place, const Pose* pose, int dimension) {
  double nearest = std::numeric_limits<double>::infinity();
  double angle = 0.0;  // that the surface fills, seen from the place: 4π from inside
  std::vector<Vec3> seen;
  for (const Vec3& v : mesh.vertices) seen.push_back((pose ? pose->moved(v) : v) - place);
  for (const auto& [i, j, k] : mesh.triangles) {
    const Vec3 &a = seen[i], &b = seen[j], &c = seen[k];
    const double la = a.norm(), lb = b.norm(), lc = c.norm();
    angle += 2.0 * std::atan2(a.dot(b.cross(c)),
                              la * lb * lc + a.dot(b) * lc + a.dot(c) * lb + b.dot(c) * la);
    const Vec3 normal = (b - a).cross(c - a);
    if (dimension == 2 && std::abs(normal.z()) > 0.5 * normal.norm()) continue;
    nearest = std::min(nearest, nearest_place(a, b, c).norm());
  }
  return std::abs(angle) > 2.0 * std::numbers::pi ? nearest : -nearest;
}

double depth_of(const Scene& s, const ObstacleScene& o, const Vec3& centre, double r, double time) {
  const bool moves = o.motion && !o.motion->surface_only;
  const Pose pose = moves ? pose_at(*o.motion, time) : Pose{};
  if (o.mesh) {
    const double inside =
        depth_in_mesh(*o.mesh->surface, centre, moves ? &pose : nullptr, s.box.dimension);
    return o.mesh->hollow ? r - inside : r + inside;
  }
  if (o.block()) {
    double inside = std::numeric_limits<double>::infinity();  // from its nearest face
    for (int k = 0; k < s.box.dimension; ++k)
      inside = std::min({inside, centre[k] - o.from[k], o.to[k] - centre[k]});
    if (inside > 0.0) return r + inside;
  }
  ObstacleScene there = o;
  if (moves) there.centre = pose.moved(o.centre);
  return 2.0 * r * depth_in(s, there, centre, r);
}

}  // namespace

std::vector<SolidOverlap> solid_overlaps(const Scene& s, const Vec3& centre, double r,
                                         double time) {
  std::vector<SolidOverlap> found;
  for (std::size_t i = 0; i < s.obstacles.size(); ++i) {
    const ObstacleScene& o = s.obstacles[i];
    if (o.image) continue;
    if (const double depth = depth_of(s, o, centre, r, time); depth > 0.0)
      found.push_back(
          {o.grain
               ? fmt::format("the grain at rest at {}", place_text(s, o.centre))
               : fmt::format(
                     "the {}. obstacle{}", i + 1,
                     o.mesh ? fmt::format(" (mesh {})",
                                          std::filesystem::path(o.mesh->file).filename().string())
                            : ""),
           depth, o.motion && !o.motion->surface_only, !o.round && depth > r,
           o.mesh && std::abs(depth - r) <= kOnSurface * r});
  }
  for (int k = 0; k < s.box.dimension; ++k) {
    if (s.box.sides[k] != SideKind::Wall) continue;
    const double low = centre[k] - s.box.origin[k], high = s.box.size[k] - low;
    for (const int up : {0, 1})
      if (const double depth = r - (up ? high : low); depth > 0.0)
        found.push_back({fmt::format("the wall \"{}\"", kSideNames[2 * k + up]), depth});
  }
  std::ranges::stable_sort(found, [](const auto& a, const auto& b) { return a.depth > b.depth; });
  return found;
}

}  // namespace lbm
