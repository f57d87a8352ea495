// SPDX-License-Identifier: GPL-2.0-or-later
#include "lbm_solver/immersed/geometry.h"

#include <gtest/gtest.h>

#include <numbers>
#include <numeric>

#include "lbm_solver/immersed/cover_map.h"
#include "lbm_solver/immersed/mesh_fractions.h"
#include "tests/support/meshes.h"

namespace {

using namespace lbm;

const Domain kDomain{20, 18, Side::Wall, Side::Wall, 16, Side::Wall};
const Vec3 kMiddle(10.0, 9.0, 8.0);

using Fractions = std::vector<double>;  // [z][y][x]

Fractions fractions(const Geometry& geometry, const Domain& domain = kDomain,
                    const RadiusShift& shift = {}) {
  Fractions all(static_cast<std::size_t>(domain.nx) * domain.ny * domain.nz, 0.0);
  fill(geometry, domain, Block::whole(domain), shift, [&](const FractionSpan& span) {
    for (std::size_t k = 0; k < span.fractions.size(); ++k)
      all[(span.z * domain.ny + span.y) * domain.nx + span.x + k] += span.fractions[k];
  });
  return all;
}

Geometry of(TriangleMesh mesh, bool hollow = false) {
  return {MeshSolid{std::make_shared<const TriangleMesh>(std::move(mesh)), hollow}};
}

double sum(const Fractions& all) {
  return std::accumulate(all.begin(), all.end(), 0.0);
}

// The sum over the cells is the volume, whatever the direction: ε is a volume to round-off.
TEST(MeshFractions, AddUpToTheVolume) {
  for (const double angle : {0.0, 0.3, 1.1}) {
    const TriangleMesh box = test::turned(test::box_mesh({6.3, 5.2, 4.9}, {13.1, 12.7, 10.4}),
                                          kMiddle, {0.3, -1.0, 0.6}, angle);
    EXPECT_NEAR(sum(fractions(of(box))), 6.8 * 7.5 * 5.5, 1e-9) << angle;
  }
  const TriangleMesh ball = test::sphere_mesh(kMiddle, 5.3, 4);
  EXPECT_NEAR(sum(fractions(of(ball))), enclosed_volume(ball), 1e-9);
}

// Every cell of a turned box against the part of 40 × 40 × 40 places in it that lie in the box:
// a surface through a cell puts about 40² of them on one side or the other, 1e-3 of the cell.
TEST(MeshFractions, AreThoseOfPlacesInEachCell) {
  const Vec3 low(7.3, 6.2, 5.9), high(12.1, 11.7, 9.4), axis(0.3, -1.0, 0.6);
  const double angle = 0.7;
  const Fractions found =
      fractions(of(test::turned(test::box_mesh(low, high), kMiddle, axis, angle)));
  const Eigen::AngleAxisd back(-angle, axis.normalized());
  constexpr int kPlaces = 40;
  double worst = 0.0;
  for (int z = 0; z < kDomain.nz; ++z)
    for (int y = 6; y < 12; ++y)
      for (int x = 6; x < 12; ++x) {
        int inside = 0;
        for (int k = 0; k < kPlaces; ++k)
          for (int j = 0; j < kPlaces; ++j)
            for (int i = 0; i < kPlaces; ++i) {
              const Vec3 place(x + (i + 0.5) / kPlaces, y + (j + 0.5) / kPlaces,
                               z + (k + 0.5) / kPlaces);
              const Vec3 own = kMiddle + back * (place - kMiddle);
              inside += (own.array() > low.array()).all() && (own.array() < high.array()).all();
            }
        const double part = static_cast<double>(inside) / (kPlaces * kPlaces * kPlaces);
        worst = std::max(worst, std::abs(part - found[(z * kDomain.ny + y) * kDomain.nx + x]));
      }
  EXPECT_LT(worst, 3e-3);
}

TEST(MeshFractions, OfABoxOnTheCellsAreThoseOfABlock) {
  const CellBox block{{4, 3, 2}, {11, 9, 8}};
  const double off = 1e-13;  // as a length in metres over the cell has it
  const Geometry mesh = of(test::box_mesh({4 + off, 3 - off, 2}, {11 - off, 9 + off, 8}));
  EXPECT_EQ(fractions(mesh), fractions({block}));
  const Geometry outside = of(test::box_mesh({-5, 3, -2}, {30, 9, 8}));  // cut at the sides
  EXPECT_EQ(fractions(outside), fractions({CellBox{{0, 3, 0}, {20, 9, 8}}}));
}

TEST(MeshFractions, OfAHollowMeshAreTheRest) {
  const TriangleMesh tube = test::cylinder_mesh({-2.0, 9.3, 8.1}, {23.0, 8.9, 7.7}, 5.4, 48);
  Fractions inside = fractions(of(tube)), outside = fractions(of(tube, true));
  for (std::size_t i = 0; i < inside.size(); ++i) ASSERT_NEAR(inside[i] + outside[i], 1.0, 1e-9);
}

TEST(MeshFractions, AreTheSameOnEveryBlockOfRanks) {
  const Geometry ball = of(test::sphere_mesh({8.2, 9.1, 7.7}, 5.3, 3));
  const Fractions whole = fractions(ball);
  Block part = Block::whole(kDomain);
  part.begin = {7, 4, 6};
  part.size = {9, 11, 7};
  int cells = 0;
  fill(ball, kDomain, part, {}, [&](const FractionSpan& span) {
    for (std::size_t k = 0; k < span.fractions.size(); ++k, ++cells) {
      const std::size_t x = span.x + 7 + k, y = span.y + 4, z = span.z + 6;
      ASSERT_NEAR(span.fractions[k], whole[(z * kDomain.ny + y) * kDomain.nx + x], 1e-12);
    }
  });
  EXPECT_GT(cells, 200);
}

TEST(MeshFractions, OfASurfaceThatFacesInwardsAreRefused) {
  TriangleMesh box = test::box_mesh({4.5, 3.5, 2.5}, {11.5, 9.5, 8.5});
  for (auto& t : box.triangles) std::swap(t[1], t[2]);
  EXPECT_THROW(fractions(of(box)), std::invalid_argument);
}

// Two shells, the inner one facing inwards: what lies between them.
TEST(MeshFractions, HaveCavities) {
  TriangleMesh inner = test::sphere_mesh(kMiddle, 3.0, 3);
  for (auto& t : inner.triangles) std::swap(t[1], t[2]);
  const TriangleMesh outer = test::sphere_mesh(kMiddle, 6.0, 3);
  const Fractions shell = fractions(of(test::together({outer, inner})));
  EXPECT_NEAR(sum(shell), enclosed_volume(outer) + enclosed_volume(inner), 1e-9);
  EXPECT_EQ(shell[(8 * kDomain.ny + 9) * kDomain.nx + 10], 0.0);
}

// Cells at a curved surface get what the shift of the radius gives a ball of the same size: in all
// of them together the layer of that thickness, within what is lost in cells that it fills.
TEST(MeshFractions, OfACurvedSurfaceAreShifted) {
  const RadiusShift shift{-0.005, 0.16};
  const double r = 5.3;
  const TriangleMesh ball = test::sphere_mesh(kMiddle, r, 4);
  const double added = sum(fractions(of(ball), kDomain, shift)) - enclosed_volume(ball);
  const double layer = 4.0 * std::numbers::pi * r * r * (shift.radius(r, false) - r);
  EXPECT_NEAR(added, layer, 0.1 * layer);
  const double taken =
      sum(fractions(of(ball, true), kDomain, shift)) - sum(fractions(of(ball, true), kDomain));
  const double hollow = 4.0 * std::numbers::pi * r * r * (r - shift.radius(r, true));
  EXPECT_NEAR(taken, hollow, 0.1 * std::abs(hollow));
}

// A body far smaller than a cell covers no more than its own size tells, up to the correction of
// one that is two cells wide. (The correction for its curvature once filled the whole box.)
TEST(Fractions, OfBodiesSmallerThanACellFallWithTheirSize) {
  for (const int dimension : {2, 3}) {
    const Domain domain = dimension == 2 ? Domain{20, 18, Side::Wall, Side::Wall} : kDomain;
    const RadiusShift shift = radius_shift(SolidTerm::Resistance, dimension);
    for (double r = 1.0; r > 1e-7; r *= 0.3) {
      const double whole =
          dimension == 2 ? std::numbers::pi * r * r : 4.0 / 3.0 * std::numbers::pi * r * r * r;
      const Vec3 at(9.3, 8.4, dimension == 2 ? 0.0 : 8.6);
      EXPECT_LE(sum(fractions({Ball{at, r, false}}, domain, shift)), 1.6 * whole + 1e-12) << r;
      if (dimension == 3) {
        const Geometry mesh = of(test::sphere_mesh(at, r, 2));
        EXPECT_LE(sum(fractions(mesh, domain, shift)), 1.6 * whole) << r;
      }
    }
  }
}

TEST(TriangleMesh, KnowsItsMeanCurvature) {
  const auto mean = [](const std::vector<double>& v) {
    return std::accumulate(v.begin(), v.end(), 0.0) / static_cast<double>(v.size());
  };
  EXPECT_NEAR(mean(mean_curvatures(test::sphere_mesh({}, 4.0, 3))), 0.25, 0.005);
  for (const double h : mean_curvatures(test::box_mesh({0, 0, 0}, {1, 2, 3}))) EXPECT_EQ(h, 0.0);
}

TEST(TriangleMesh, NamesWhatIsWrongWithASurface) {
  TriangleMesh box = test::box_mesh({0, 0, 0}, {1, 1, 1});
  SurfaceDefects found = defects(box);
  EXPECT_EQ(found.open + found.turned + found.crowded, 0U);
  std::swap(box.triangles[3][0], box.triangles[3][1]);
  EXPECT_EQ(defects(box).turned, 3U);
  box.triangles.pop_back();
  EXPECT_EQ(defects(box).open, 3U);
  box = test::box_mesh({0, 0, 0}, {1, 1, 1});
  box.triangles.push_back(box.triangles.front());
  found = defects(box);
  EXPECT_EQ(found.crowded, 3U);
  EXPECT_TRUE(found.at_crowded.has_value());
}

TEST(TriangleMesh, BecomesAClosedLayer) {
  const TriangleMesh plate{{{2, 2, 5}, {14, 2, 5}, {14, 12, 5}, {2, 12, 5}},
                           {{0, 1, 2}, {0, 2, 3}}};
  const TriangleMesh layer = thickened(plate, 3.0);
  const SurfaceDefects found = defects(layer);
  EXPECT_EQ(found.open + found.turned + found.crowded, 0U);
  EXPECT_NEAR(enclosed_volume(layer), 12.0 * 10.0 * 3.0, 1e-12);
  EXPECT_EQ(fractions(of(layer))[(5 * kDomain.ny + 7) * kDomain.nx + 7], 1.0);
  const TriangleMesh shell = thickened(test::sphere_mesh(kMiddle, 5.0, 4), 1.0);  // closed: a shell
  const double exact = 4.0 / 3.0 * std::numbers::pi * (5.5 * 5.5 * 5.5 - 4.5 * 4.5 * 4.5);
  EXPECT_NEAR(enclosed_volume(shell), exact, 0.01 * exact);
}

TEST(VoxelSolid, IsScaledByWholeNumbersOrAveraged) {
  auto voxels = std::make_shared<Voxels>();
  voxels->size = {4, 2, 2};
  voxels->solid = {0, 1, 1, 0, 0, 0, 1, 0.5, 0, 1, 1, 0, 0, 1, 1, 0};
  const Domain small{10, 8, Side::Wall, Side::Wall, 6, Side::Wall};
  const auto at = [&](const Fractions& all, int x, int y, int z) {
    return all[(z * small.ny + y) * small.nx + x];
  };
  const Fractions twice = fractions({VoxelSolid{voxels, {1, 2, 0}, 2, 1}}, small);
  EXPECT_EQ(sum(twice), 8 * 7.5);
  EXPECT_EQ(at(twice, 2, 2, 0), 0.0);
  EXPECT_EQ(at(twice, 3, 2, 0), 1.0);
  EXPECT_EQ(at(twice, 7, 4, 1), 0.5);
  const Fractions half = fractions({VoxelSolid{voxels, {3, 3, 3}, 1, 2}}, small);
  EXPECT_EQ(at(half, 3, 3, 3), 3.0 / 8.0);
  EXPECT_EQ(at(half, 4, 3, 3), 4.5 / 8.0);
  EXPECT_EQ(sum(half), 7.5 / 8.0);
  const Domain flat{10, 8, Side::Wall, Side::Wall};
  voxels->size = {4, 4, 1};
  EXPECT_EQ(sum(fractions({VoxelSolid{voxels, {1, 0, 0}, 2, 1}}, flat)), 4 * 7.5);
  EXPECT_EQ(sum(fractions({VoxelSolid{voxels, {1, 1, 0}, 1, 2}}, flat)), 7.5 / 4.0);
}

TEST(Ball, AsAShapeCoversWhatABodyDoes) {
  const Ball ball{{9.3, 8.8, 7.9}, 4.7};
  CoverMap bodies(kDomain);
  Body body;
  body.centre = ball.centre;
  body.radius = ball.radius;
  bodies.update({&body, 1});
  const Fractions found = fractions({ball});
  for (int z = 0; z < kDomain.nz; ++z)
    for (int y = 0; y < kDomain.ny; ++y)
      for (int x = 0; x < kDomain.nx; ++x)
        ASSERT_EQ(found[(z * kDomain.ny + y) * kDomain.nx + x], bodies.solid_fraction(x, y, z));
}

}  // namespace
