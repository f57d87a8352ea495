// SPDX-License-Identifier: GPL-2.0-or-later
/// Surfaces as they are offered to LIGGGHTS.
#include "lbm_solver/base/mesh_cut.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cstdio>
#include <numbers>
#include <random>
#include <set>

#include "tests/support/meshes.h"

namespace {

using namespace lbm;

constexpr double kSoftLimit = 0.5 * std::numbers::pi / 180.0;  // LIGGGHTS warns below
const Vec3 kLow(0.0, 0.0, 0.0), kHigh(0.012, 0.01, 0.014);     // of the box

double area(const TriangleMesh& mesh) {
  double twice = 0.0;
  for (const auto& t : mesh.triangles) twice += mesh.area_vector(t).norm();
  return 0.5 * twice;
}

/// Area of the part of a surface in the box, each triangle cut by itself.
double area_in_box(const TriangleMesh& mesh) {
  double twice = 0.0;
  for (const auto& t : mesh.triangles) {
    std::vector<Vec3> part{mesh.vertices[t[0]], mesh.vertices[t[1]], mesh.vertices[t[2]]};
    for (int side = 0; side < 6; ++side) {
      const int k = side / 2;
      const auto inside = [&](const Vec3& x) {  // by how far
        return side % 2 == 0 ? x[k] - kLow[k] : kHigh[k] - x[k];
      };
      std::vector<Vec3> rest;
      for (std::size_t i = 0; i < part.size(); ++i) {
        const Vec3 &a = part[i], &b = part[(i + 1) % part.size()];
        if (inside(a) >= 0.0) rest.push_back(a);
        if ((inside(a) >= 0.0) != (inside(b) >= 0.0))
          rest.push_back(a + inside(a) / (inside(a) - inside(b)) * (b - a));
      }
      part = rest;
    }
    for (std::size_t i = 1; i + 1 < part.size(); ++i)
      twice += (part[i] - part[0]).cross(part[i + 1] - part[0]).norm();
  }
  return 0.5 * twice;
}

/// Length of the edges of one triangle that do not lie on the box's sides.
double open_length(const TriangleMesh& mesh) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> edges;
  for (const auto& t : mesh.triangles)
    for (int k = 0; k < 3; ++k) ++edges[std::minmax(t[k], t[(k + 1) % 3])];
  double length = 0.0;
  for (const auto& [ends, count] : edges) {
    const Vec3 &a = mesh.vertices[ends.first], &b = mesh.vertices[ends.second];
    bool on_side = false;
    for (int k = 0; k < 3; ++k)
      on_side =
          on_side || (a[k] == kLow[k] && b[k] == kLow[k]) || (a[k] == kHigh[k] && b[k] == kHigh[k]);
    if (count == 1 && !on_side) length += (b - a).norm();
  }
  return length;
}

void expect_taken(const TriangleMesh& mesh, const std::string& what) {
  EXPECT_GE(sharpest_angle(mesh), kSoftLimit) << what;
  const auto [low, high] = bounds(mesh);
  EXPECT_GE((low - kLow).minCoeff(), 0.0) << what;
  EXPECT_GE((kHigh - high).minCoeff(), 0.0) << what;
  std::set<std::array<std::uint32_t, 3>> known;
  for (auto t : mesh.triangles) {
    std::ranges::sort(t);
    EXPECT_TRUE(known.insert(t).second) << what << ": twice";
  }
}

TEST(CutMeshes, ARodInTheBoxIsPartedAndStaysClosed) {
  for (const double length : {0.005, 0.008, 0.0118}) {
    const TriangleMesh rod = of_fewer_sides(
        cylinder_surface({0.0001, 0.005, 0.007}, {0.0001 + length, 0.005, 0.007}, 0.00035));
    const TriangleMesh offered = clipped(rod, kLow, kHigh);
    std::printf("length %g D: sharpest %.4f rad before, %.4f after, %zu triangles\n",
                length / 0.0007, sharpest_angle(rod), sharpest_angle(offered),
                offered.triangles.size());
    expect_taken(offered, std::to_string(length));
    EXPECT_EQ(defects(offered).open + defects(offered).turned + defects(offered).crowded, 0U);
    EXPECT_NEAR(enclosed_volume(offered), enclosed_volume(rod), 1e-12 * enclosed_volume(rod));
  }
}

TEST(CutMeshes, ARodOfFewerSidesHasItsVolume) {
  const TriangleMesh rod = cylinder_surface({0.001, 0.002, 0.003}, {0.008, 0.005, 0.007}, 0.001);
  const TriangleMesh fewer = of_fewer_sides(rod);
  EXPECT_EQ(4 * fewer.triangles.size(), rod.triangles.size());
  EXPECT_NEAR(enclosed_volume(fewer), enclosed_volume(rod), 1e-12 * enclosed_volume(rod));
  EXPECT_EQ(defects(fewer).open + defects(fewer).turned + defects(fewer).crowded, 0U);
  // 64 sides: corners are R (π/32 / sin(π/32))^½ away, sides a cosine of π/64 of that
  EXPECT_LT((bounds(fewer)[0] - bounds(rod)[0]).norm(), 1.3e-3 * 0.001);
}

// At all angles, also lengthwise and through corners of the box. What is taken out is as large as
// its slivers, and no gap is left but where they were flat.
TEST(CutMeshes, ARodThatIsCutAtAnAngleLeavesNoSlivers) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> part(-1.0, 1.0);
  double worst_area = 0.0, worst_gap = 0.0;  // radii
  for (int i = 0; i < 60; ++i) {
    const auto vector = [&] { return Vec3(part(random), part(random), part(random)); };
    const Vec3 middle = 0.5 * (kLow + kHigh) + 0.006 * vector();
    Vec3 axis = vector().normalized();
    if (i % 4 == 0) axis = Vec3::Unit(i % 3) + 1e-4 * (i % 8) * axis;  // along a side, or nearly
    const double radius = 0.0005 + 0.0005 * (i % 3), reach = i % 5 == 0 ? 100.0 : 0.03;
    const TriangleMesh rod =
        of_fewer_sides(cylinder_surface(middle - reach * axis, middle + reach * axis, radius));
    const double exact = area_in_box(rod);
    if (exact == 0.0) continue;  // it passes the box
    const TriangleMesh offered = clipped(rod, kLow, kHigh);
    expect_taken(offered, "rod " + std::to_string(i));
    worst_gap = std::max(worst_gap, open_length(offered) / radius);
    worst_area = std::max(worst_area, std::abs(area(offered) - exact) / (radius * radius));
  }
  std::printf("area off by %.2g radii², open edges of %.2g radii\n", worst_area, worst_gap);
  constexpr double facet = std::numbers::pi / 32.0;  // wide, and 60 times as long
  EXPECT_LT(worst_area, facet * facet);
  EXPECT_LT(worst_gap, 30.0 * facet);  // half of one
}

TEST(CutMeshes, WhatLiesInTheBoxStaysAsItIs) {
  const TriangleMesh ball = test::sphere_mesh({0.006, 0.005, 0.007}, 0.004, 3);
  const TriangleMesh same = clipped(ball, kLow, kHigh);
  EXPECT_EQ(same.triangles, ball.triangles);
  EXPECT_EQ(same.vertices, ball.vertices);
  // beyond by round-off alone: LIGGGHTS would warn
  const TriangleMesh block =
      clipped(test::box_mesh({-2e-19, 0.001, 0.0}, {0.004, 0.01 + 2e-18, 0.002}), kLow, kHigh);
  EXPECT_EQ(bounds(block)[0].x(), 0.0);
  EXPECT_EQ(bounds(block)[1].y(), kHigh.y());
}

TEST(CutMeshes, EndsInTwoPeriodicSidesAreLeftOut) {
  const TriangleMesh block = test::box_mesh({0.0, 0.001, 0.0}, {0.012, 0.004, 0.002});
  const TriangleMesh open = without_ends(block, 0, kLow.x(), kHigh.x());
  EXPECT_EQ(open.triangles.size(), 8U);
  for (const auto& t : open.triangles) EXPECT_EQ(open.area_vector(t).x(), 0.0);
  EXPECT_EQ(without_ends(block, 2, kLow.z(), kHigh.z()).triangles, block.triangles);  // in one
  const TriangleMesh rod =
      clipped(cylinder_surface({0.0, 0.005, 0.007}, {0.012, 0.005, 0.007}, 0.001), kLow, kHigh);
  const TriangleMesh pipe = without_ends(rod, 0, kLow.x(), kHigh.x());
  EXPECT_NEAR(area(rod) - area(pipe), 2.0 * std::numbers::pi * 1e-6, 1e-12);
}

// Long triangles of any mesh, as of a plate: ends stay where they are.
TEST(CutMeshes, AThinPlateIsParted) {
  const TriangleMesh plate = test::box_mesh({0.001, 0.001, 0.001}, {0.011, 0.00102, 0.006});
  const TriangleMesh offered = clipped(plate, kLow, kHigh);
  expect_taken(offered, "plate");
  EXPECT_EQ(bounds(offered)[0], bounds(plate)[0]);
  EXPECT_EQ(bounds(offered)[1], bounds(plate)[1]);
  EXPECT_NEAR(area(offered), area(plate), 1e-12 * area(plate));
}

}  // namespace
