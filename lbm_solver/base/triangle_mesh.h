// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "lbm_solver/base/vec3.h"

namespace lbm {

/// A surface of flat triangles. Seen from outside of the solid the corners of each run
/// counter-clockwise.
struct TriangleMesh {
  using Triangle = std::array<std::uint32_t, 3>;

  std::vector<Vec3> vertices;
  std::vector<Triangle> triangles;  ///< numbers of vertices

  /// Twice a triangle's area along its normal.
  Vec3 area_vector(const Triangle& t) const;
};

/// What keeps a surface from saying what lies inside of it. Each edge should have two triangles
/// that run along it in opposite directions.
struct SurfaceDefects {
  std::size_t open = 0;     ///< edges of one triangle: a hole, or the rim of a thin surface
  std::size_t turned = 0;   ///< edges along which two triangles run the same way: one is flipped
  std::size_t crowded = 0;  ///< edges of more than two triangles
  std::optional<Vec3> at_open, at_turned, at_crowded;  ///< the middle of the first of each
};
SurfaceDefects defects(const TriangleMesh& mesh);

/// That a closed surface encloses; negative where its triangles face inwards.
double enclosed_volume(const TriangleMesh& mesh);

/// Lower and upper corner of the box around a mesh.
std::array<Vec3, 2> bounds(const TriangleMesh& mesh);

/// The surface of the box between two corners.
TriangleMesh box_surface(const Vec3& low, const Vec3& high);
/// A sphere of many triangles, or a cylinder along z from -1 to 1, which is a disc in two
/// dimensions; of the volume of the round one.
TriangleMesh round_surface(const Vec3& centre, double radius, int dimension);

/// A cylinder between the centres of its ends, of the volume of the round one.
TriangleMesh cylinder_surface(const Vec3& from, const Vec3& to, double radius);

/// A closed surface around the layer that lies within half a thickness of a surface, which may
/// have rims.
TriangleMesh thickened(const TriangleMesh& mesh, double thickness);

/// Mean curvature at each vertex, positive where the inside is convex: 1/R on a sphere, 1/(2R) on a
/// cylinder. Edges sharper than 40 degrees are edges, and not curved.
std::vector<double> mean_curvatures(const TriangleMesh& mesh);

}  // namespace lbm
