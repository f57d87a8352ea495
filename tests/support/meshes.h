// SPDX-License-Identifier: GPL-2.0-or-later
/// Surfaces to test with.
#pragma once

#include <Eigen/Geometry>
#include <cmath>
#include <map>
#include <numbers>

#include "lbm_solver/base/triangle_mesh.h"

namespace test {

using lbm::TriangleMesh;
using lbm::Vec3;

/// A sphere of 20 × 4^rounds triangles, corners on the sphere.
inline TriangleMesh sphere_mesh(const Vec3& centre, double radius, int rounds) {
  const double g = std::numbers::phi;
  std::vector<Vec3> x{{-1, g, 0},  {1, g, 0},  {-1, -g, 0}, {1, -g, 0}, {0, -1, g},  {0, 1, g},
                      {0, -1, -g}, {0, 1, -g}, {g, 0, -1},  {g, 0, 1},  {-g, 0, -1}, {-g, 0, 1}};
  std::vector<TriangleMesh::Triangle> faces{
      {0, 11, 5},  {0, 5, 1},  {0, 1, 7},  {0, 7, 10}, {0, 10, 11}, {1, 5, 9}, {5, 11, 4},
      {11, 10, 2}, {10, 7, 6}, {7, 1, 8},  {3, 9, 4},  {3, 4, 2},   {3, 2, 6}, {3, 6, 8},
      {3, 8, 9},   {4, 9, 5},  {2, 4, 11}, {6, 2, 10}, {8, 6, 7},   {9, 8, 1}};
  for (int round = 0; round < rounds; ++round) {
    std::map<std::pair<unsigned, unsigned>, unsigned> middles;
    const auto middle = [&](unsigned a, unsigned b) {
      const auto [at, is_new] = middles.emplace(std::minmax(a, b), x.size());
      if (is_new) x.push_back(0.5 * (x[a] + x[b]));
      return at->second;
    };
    std::vector<TriangleMesh::Triangle> finer;
    for (const auto& [a, b, c] : faces) {
      const unsigned ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
      finer.insert(finer.end(), {{a, ab, ca}, {b, bc, ab}, {c, ca, bc}, {ab, bc, ca}});
    }
    for (Vec3& v : x) v.normalize();
    faces.swap(finer);
  }
  for (Vec3& v : x) v = centre + radius * v.normalized();
  return {x, faces};
}

/// The box between two corners.
inline TriangleMesh box_mesh(const Vec3& low, const Vec3& high) {
  return lbm::box_surface(low, high);
}

/// A straight cylinder with flat ends.
inline TriangleMesh cylinder_mesh(const Vec3& from, const Vec3& to, double radius,
                                  unsigned around) {
  const Vec3 axis = (to - from).normalized();
  const Vec3 other = std::abs(axis.z()) < 0.9 ? Vec3(0, 0, 1) : Vec3(1, 0, 0);
  const Vec3 e = axis.cross(other).normalized(), f = axis.cross(e);
  TriangleMesh mesh{{from, to}, {}};
  for (unsigned k = 0; k < around; ++k) {
    const double angle = 2.0 * std::numbers::pi * k / around;
    const Vec3 arm = radius * (std::cos(angle) * e + std::sin(angle) * f);
    mesh.vertices.push_back(from + arm);
    mesh.vertices.push_back(to + arm);
  }
  for (unsigned k = 0; k < around; ++k) {
    const unsigned a = 2 + 2 * k, b = 2 + 2 * ((k + 1) % around);
    mesh.triangles.insert(mesh.triangles.end(),
                          {{a, b, b + 1}, {a, b + 1, a + 1}, {0, b, a}, {1, a + 1, b + 1}});
  }
  return mesh;
}

/// Several surfaces as one.
inline TriangleMesh together(const std::vector<TriangleMesh>& parts) {
  TriangleMesh all;
  for (const TriangleMesh& part : parts) {
    const auto n = static_cast<unsigned>(all.vertices.size());
    all.vertices.insert(all.vertices.end(), part.vertices.begin(), part.vertices.end());
    for (const auto& [a, b, c] : part.triangles) all.triangles.push_back({a + n, b + n, c + n});
  }
  return all;
}

/// Turned about an axis through a place.
inline TriangleMesh turned(TriangleMesh mesh, const Vec3& place, const Vec3& axis, double angle) {
  const Eigen::AngleAxisd turn(angle, axis.normalized());
  for (Vec3& v : mesh.vertices) v = place + turn * (v - place);
  return mesh;
}

}  // namespace test
