// SPDX-License-Identifier: GPL-2.0-or-later
#include "lbm_solver/base/mesh_cut.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

namespace lbm {
namespace {

using Polygon = std::vector<Vec3>;

constexpr double kFlat = 1e-10;    // of the cosine between two triangles of one plane
constexpr double kLongest = 20.0;  // length over width of a piece
constexpr double kOnSide = 1e-9;   // of the box's size: a corner lies on its side

/// Where an edge crosses a plane; the same to the bit from both of the triangles that share it.
Vec3 crossing(Vec3 a, Vec3 b, int axis, double place) {
  if (a[axis] > b[axis]) std::swap(a, b);
  Vec3 x = a + (place - a[axis]) / (b[axis] - a[axis]) * (b - a);
  x[axis] = place;
  return x;
}

/// What is left of a convex polygon on one side of a plane.
/// @param sign  1: below the place, -1: above
Polygon half(const Polygon& polygon, int axis, double place, double sign, double near) {
  Polygon rest;
  const auto beyond = [&](const Vec3& x) { return sign * (x[axis] - place) > near; };
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Vec3 &a = polygon[i], &b = polygon[(i + 1) % polygon.size()];
    if (!beyond(a)) rest.push_back(a);
    // an edge that ends on the plane has no other end there
    const auto inside = [&](const Vec3& x) { return sign * (x[axis] - place) < -near; };
    if ((beyond(a) && inside(b)) || (inside(a) && beyond(b)))
      rest.push_back(crossing(a, b, axis, place));
  }
  return rest;
}

Polygon polygon_of(const TriangleMesh& mesh, const TriangleMesh::Triangle& t) {
  return {mesh.vertices[t[0]], mesh.vertices[t[1]], mesh.vertices[t[2]]};
}

/// The quadrangle of two triangles {a, b, d}, {a, d, c} in one plane; empty where they are none.
Polygon joined_pair(const TriangleMesh& mesh, const TriangleMesh::Triangle& s,
                    const TriangleMesh::Triangle& t) {
  if (s[0] != t[0] || s[2] != t[1]) return {};
  const Vec3 m = mesh.area_vector(s), n = mesh.area_vector(t);
  if (m.dot(n) < (1.0 - kFlat) * m.norm() * n.norm()) return {};
  return {mesh.vertices[s[0]], mesh.vertices[s[1]], mesh.vertices[s[2]], mesh.vertices[t[2]]};
}

void add_triangle(const Vec3& a, const Vec3& b, const Vec3& c, double near, TriangleMesh& part) {
  const auto first = static_cast<std::uint32_t>(part.vertices.size());
  part.vertices.insert(part.vertices.end(), {a, b, c});
  const TriangleMesh::Triangle piece{first, first + 1, first + 2};
  if (part.area_vector(piece).norm() > near * near)
    part.triangles.push_back(piece);
  else
    part.vertices.resize(first);
}

/// Triangles of a convex polygon. A long quadrangle is parted along its length: LIGGGHTS refuses
/// triangles with an angle below 0.0045.
void add_pieces(const Polygon& polygon, double near, TriangleMesh& part) {
  if (polygon.size() != 4) {
    for (std::size_t i = 1; i + 1 < polygon.size(); ++i)
      add_triangle(polygon[0], polygon[i], polygon[i + 1], near, part);
    return;
  }
  const auto side = [&](int k) { return (polygon[(k + 1) % 4] - polygon[k]).norm(); };
  const int first = side(0) + side(2) > side(1) + side(3) ? 0 : 1;  // a long side begins here
  const double across = std::max(side(first + 1), side((first + 3) % 4));
  const double along = std::max(side(first), side((first + 2) % 4));
  if (across <= near) return;
  const int pieces =
      static_cast<int>(std::clamp(std::ceil(along / (kLongest * across)), 1.0, 1000.0));
  const auto at = [&](int from, int to, int piece) -> Vec3 {
    const Vec3 &a = polygon[from % 4], &b = polygon[to % 4];
    return a + (1.0 * piece / pieces) * (b - a);
  };
  for (int p = 0; p < pieces; ++p) {
    const Vec3 a = at(first, first + 1, p), b = at(first, first + 1, p + 1),
               c = at(first + 3, first + 2, p + 1), d = at(first + 3, first + 2, p);
    add_triangle(a, b, c, near, part);
    add_triangle(a, c, d, near, part);
  }
}

}  // namespace

TriangleMesh clipped(const TriangleMesh& mesh, const Vec3& low, const Vec3& high) {
  const double near = kOnSide * (high - low).maxCoeff();
  const auto lies_in = [&](const TriangleMesh::Triangle& t) {
    return std::ranges::all_of(t, [&](std::uint32_t v) {
      const Vec3& x = mesh.vertices[v];
      return (low - x).maxCoeff() <= near && (x - high).maxCoeff() <= near;
    });
  };
  if (std::ranges::all_of(mesh.triangles, lies_in)) return mesh;
  TriangleMesh part;
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    Polygon rest = polygon_of(mesh, mesh.triangles[i]);
    if (i + 1 < mesh.triangles.size())
      if (const Polygon both = joined_pair(mesh, mesh.triangles[i], mesh.triangles[i + 1]);
          !both.empty()) {
        rest = both;
        ++i;
      }
    for (int k = 0; k < 3; ++k) {
      rest = half(rest, k, low[k], -1.0, near);
      rest = half(rest, k, high[k], 1.0, near);
    }
    add_pieces(rest, near, part);
  }
  return part.triangles.empty() ? mesh : part;
}

double largest_reach(const TriangleMesh& mesh) {
  double most = 0.0;
  for (const auto& t : mesh.triangles) {
    const Vec3 middle = (mesh.vertices[t[0]] + mesh.vertices[t[1]] + mesh.vertices[t[2]]) / 3.0;
    for (const auto v : t) most = std::max(most, (mesh.vertices[v] - middle).norm());
  }
  return most;
}

TriangleMesh short_walls(const TriangleMesh& block, double reach) {
  // of a square's half with sides s the farthest corner is √5/3 s away
  const double side = 0.99 * 3.0 / std::sqrt(5.0) * reach;
  const auto [low, high] = bounds(block);
  const double z = std::min(high.z(), 0.5 * side);
  const Vec3 corners[] = {{low.x(), low.y(), 0.0},
                          {high.x(), low.y(), 0.0},
                          {high.x(), high.y(), 0.0},
                          {low.x(), high.y(), 0.0}};
  TriangleMesh walls;
  for (int k = 0; k < 4; ++k) {  // counter-clockwise: what lies to the right is outside
    const Vec3 &from = corners[k], &to = corners[(k + 1) % 4];
    const auto pieces = static_cast<std::uint32_t>(std::ceil((to - from).norm() / side));
    const auto first = static_cast<std::uint32_t>(walls.vertices.size());
    for (std::uint32_t i = 0; i <= pieces; ++i)
      for (const double end : {-z, z})
        walls.vertices.push_back(from + (1.0 * i / pieces) * (to - from) + Vec3(0.0, 0.0, end));
    for (std::uint32_t a = first; a < first + 2 * pieces; a += 2) {
      walls.triangles.push_back({a, a + 2, a + 3});
      walls.triangles.push_back({a, a + 3, a + 1});
    }
  }
  return walls;
}

}  // namespace lbm
