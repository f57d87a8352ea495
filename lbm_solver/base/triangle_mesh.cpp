// SPDX-License-Identifier: GPL-2.0-or-later
#include "lbm_solver/base/triangle_mesh.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <tuple>

namespace lbm {
namespace {

using Number = std::uint32_t;

constexpr double kCrease = 0.7;          // rad
constexpr double kSharpestMitre = 0.25;  // of a corner's shift: what is sharper is cut off

Vec3 cross(const Vec3& a, const Vec3& b) {
  return {a.y() * b.z() - a.z() * b.y(), a.z() * b.x() - a.x() * b.z(),
          a.x() * b.y() - a.y() * b.x()};
}

/// A side of a triangle, from its corner k to the next.
struct Side {
  Number low, high;  ///< its vertices
  Number triangle;
  bool upwards;  ///< it runs from low to high
};

/// All sides, those of one edge together.
std::vector<Side> sides_of(const TriangleMesh& mesh) {
  std::vector<Side> sides;
  sides.reserve(3 * mesh.triangles.size());
  for (Number t = 0; t < mesh.triangles.size(); ++t)
    for (int k = 0; k < 3; ++k) {
      const Number a = mesh.triangles[t][k], b = mesh.triangles[t][(k + 1) % 3];
      sides.push_back({std::min(a, b), std::max(a, b), t, a < b});
    }
  std::sort(sides.begin(), sides.end(), [](const Side& a, const Side& b) {
    return std::tie(a.low, a.high, a.triangle) < std::tie(b.low, b.high, b.triangle);
  });
  return sides;
}

/// Calls f(first side, number of sides) for each edge.
template <class F>
void each_edge(const std::vector<Side>& sides, F&& f) {
  for (std::size_t i = 0; i < sides.size();) {
    std::size_t end = i + 1;
    while (end < sides.size() && sides[end].low == sides[i].low && sides[end].high == sides[i].high)
      ++end;
    f(&sides[i], end - i);
    i = end;
  }
}

/// Angle at corner k of a triangle.
double angle_at(const TriangleMesh& mesh, const TriangleMesh::Triangle& t, int k) {
  const Vec3 a = mesh.vertices[t[(k + 1) % 3]] - mesh.vertices[t[k]];
  const Vec3 b = mesh.vertices[t[(k + 2) % 3]] - mesh.vertices[t[k]];
  return std::atan2(cross(a, b).norm(), a.dot(b));
}

/// At each vertex the way by which it moves so that the triangles around it move by 1 along their
/// normals.
std::vector<Vec3> mitres(const TriangleMesh& mesh) {
  std::vector<Vec3> mean(mesh.vertices.size());
  std::vector<double> angles(mesh.vertices.size(), 0.0), along(mesh.vertices.size(), 0.0);
  const auto each_corner = [&](auto&& f) {
    for (const auto& t : mesh.triangles)
      for (int k = 0; k < 3; ++k) f(t[k], angle_at(mesh, t, k), mesh.area_vector(t).normalized());
  };
  each_corner([&](Number v, double angle, const Vec3& normal) { mean[v] += angle * normal; });
  for (Vec3& m : mean) m.normalize();
  each_corner([&](Number v, double angle, const Vec3& normal) {
    angles[v] += angle;
    along[v] += angle * normal.dot(mean[v]);
  });
  for (std::size_t v = 0; v < mean.size(); ++v)
    if (angles[v] > 0.0) mean[v] /= std::max(kSharpestMitre, along[v] / angles[v]);
  return mean;
}

}  // namespace

Vec3 TriangleMesh::area_vector(const Triangle& t) const {
  const Vec3& a = vertices[t[0]];
  return cross(vertices[t[1]] - a, vertices[t[2]] - a);
}

SurfaceDefects defects(const TriangleMesh& mesh) {
  SurfaceDefects found;
  const auto note = [](std::size_t& count, std::optional<Vec3>& at, const Vec3& middle) {
    if (++count == 1) at = middle;
  };
  each_edge(sides_of(mesh), [&](const Side* side, std::size_t count) {
    const Vec3 middle = 0.5 * (mesh.vertices[side->low] + mesh.vertices[side->high]);
    if (count == 1) note(found.open, found.at_open, middle);
    if (count > 2) note(found.crowded, found.at_crowded, middle);
    if (count == 2 && side[0].upwards == side[1].upwards)
      note(found.turned, found.at_turned, middle);
  });
  return found;
}

double enclosed_volume(const TriangleMesh& mesh) {
  const Vec3 origin = mesh.vertices.front();
  double six = 0.0;
  for (const auto& t : mesh.triangles) six += mesh.area_vector(t).dot(mesh.vertices[t[0]] - origin);
  return six / 6.0;
}

std::array<Vec3, 2> bounds(const TriangleMesh& mesh) {
  Vec3 low = mesh.vertices.front(), high = low;
  for (const Vec3& v : mesh.vertices) {
    low = low.cwiseMin(v);
    high = high.cwiseMax(v);
  }
  return {low, high};
}

TriangleMesh thickened(const TriangleMesh& mesh, double thickness) {
  const auto n = static_cast<Number>(mesh.vertices.size());
  TriangleMesh layer;
  const std::vector<Vec3> way = mitres(mesh);
  for (const double sign : {0.5, -0.5})
    for (Number v = 0; v < n; ++v)
      layer.vertices.push_back(mesh.vertices[v] + sign * thickness * way[v]);
  layer.triangles = mesh.triangles;
  for (const auto& [a, b, c] : mesh.triangles) layer.triangles.push_back({a + n, c + n, b + n});
  each_edge(sides_of(mesh), [&](const Side* side, std::size_t count) {
    if (count != 1) return;
    const Number from = side->upwards ? side->low : side->high;
    const Number to = side->upwards ? side->high : side->low;
    layer.triangles.push_back({from, from + n, to});
    layer.triangles.push_back({to, from + n, to + n});
  });
  return layer;
}

std::vector<double> mean_curvatures(const TriangleMesh& mesh) {
  std::vector<double> area(mesh.vertices.size(), 0.0), sum(mesh.vertices.size(), 0.0);
  std::vector<Vec3> normals;
  for (const auto& t : mesh.triangles) {
    const Vec3 twice = mesh.area_vector(t);
    normals.push_back(twice.normalized());
    for (const Number v : t) area[v] += twice.norm() / 6.0;
  }
  // over the surface around an edge of length l the mean curvature adds up to l θ / 2
  each_edge(sides_of(mesh), [&](const Side* side, std::size_t count) {
    if (count != 2) return;
    const Vec3 &m = normals[side[0].triangle], &n = normals[side[1].triangle];
    const Vec3 along = mesh.vertices[side->high] - mesh.vertices[side->low];
    const Vec3 turn = cross(m, n);
    const double sign = (turn.dot(along) > 0.0) == side->upwards ? 1.0 : -1.0;
    const double angle = std::atan2(turn.norm(), m.dot(n));
    if (angle > kCrease) return;
    for (const Number v : {side->low, side->high}) sum[v] += 0.25 * sign * angle * along.norm();
  });
  for (std::size_t v = 0; v < sum.size(); ++v)
    if (area[v] > 0.0) sum[v] /= area[v];
  return sum;
}

TriangleMesh box_surface(const Vec3& low, const Vec3& high) {
  TriangleMesh mesh;
  for (unsigned k = 0; k < 8; ++k)
    mesh.vertices.emplace_back(k & 1 ? high.x() : low.x(), k & 2 ? high.y() : low.y(),
                               k & 4 ? high.z() : low.z());
  mesh.triangles = {{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
                    {2, 6, 7}, {2, 7, 3}, {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};
  return mesh;
}

TriangleMesh cylinder_surface(const Vec3& from, const Vec3& to, double radius) {
  const Vec3 axis = (to - from).normalized();
  int across = 0;  // the box's axis that the cylinder's is farthest from
  axis.cwiseAbs().minCoeff(&across);
  const Vec3 first = cross(axis, Vec3::Unit(across)).normalized(), second = cross(axis, first);
  TriangleMesh mesh = round_surface(Vec3::Zero(), radius, 2);  // along z from -1 to 1
  for (Vec3& v : mesh.vertices)
    v = 0.5 * (from + to) + v.x() * first + v.y() * second + 0.5 * v.z() * (to - from);
  return mesh;
}

/// Rings of corners from below to above, closed by a corner at each end.
TriangleMesh round_surface(const Vec3& centre, double radius, int dimension) {
  constexpr unsigned around = 256;
  const unsigned rings = dimension == 2 ? 2 : around / 2 - 1;
  TriangleMesh mesh;
  const auto z_of = [&](unsigned ring) {
    return dimension == 2 ? (ring == 0 ? -1.0 : 1.0)
                          : -radius * std::cos(std::numbers::pi * (ring + 1) / (rings + 1));
  };
  const double end = dimension == 2 ? 1.0 : radius;
  mesh.vertices = {{0.0, 0.0, -end}, {0.0, 0.0, end}};
  for (unsigned ring = 0; ring < rings; ++ring) {
    const double z = z_of(ring), r = dimension == 2 ? radius : std::sqrt(radius * radius - z * z);
    for (unsigned k = 0; k < around; ++k) {
      const double angle = 2.0 * std::numbers::pi * k / around;
      mesh.vertices.emplace_back(r * std::cos(angle), r * std::sin(angle), z);
    }
  }
  const auto corner = [&](unsigned ring, unsigned k) { return 2 + ring * around + k % around; };
  for (unsigned k = 0; k < around; ++k) {
    mesh.triangles.push_back({0, corner(0, k + 1), corner(0, k)});
    mesh.triangles.push_back({1, corner(rings - 1, k), corner(rings - 1, k + 1)});
    for (unsigned ring = 0; ring + 1 < rings; ++ring) {
      const unsigned a = corner(ring, k), b = corner(ring, k + 1), c = corner(ring + 1, k),
                     d = corner(ring + 1, k + 1);
      mesh.triangles.insert(mesh.triangles.end(), {{a, b, d}, {a, d, c}});
    }
  }
  const double exact =
      std::numbers::pi * radius * radius * (dimension == 2 ? 2.0 : 4.0 / 3.0 * radius);
  const double wider = dimension == 2 ? std::sqrt(exact / enclosed_volume(mesh))
                                      : std::cbrt(exact / enclosed_volume(mesh));
  for (Vec3& v : mesh.vertices) {
    v.x() *= wider;
    v.y() *= wider;
    if (dimension == 3) v.z() *= wider;
    v += centre;
  }
  return mesh;
}

}  // namespace lbm
