// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include "lbm_solver/base/triangle_mesh.h"

namespace lbm {

/// The part of a surface that lies in a box, of triangles that LIGGGHTS takes: it refuses those
/// with an angle below 0.0045, and warns below 0.0087. Triangles that cross the box's sides are cut
/// there, what lies beyond is left out, and the surface is open where it was cut; corners that lie
/// on a side but for round-off are put there. Pairs of triangles that make a long quadrangle become
/// pieces along it. What is still sharp (slivers of a cut) goes: a short side becomes one vertex, a
/// flat triangle is dropped. A surface that lies in the box and has no sharp triangle stays as it
/// is; so does one that has nothing in the box.
TriangleMesh clipped(const TriangleMesh& mesh, const Vec3& low, const Vec3& high);

/// Smallest angle of all triangles [rad].
double sharpest_angle(const TriangleMesh& mesh);

/// A surface without its ends in two periodic sides, where it has as many triangles in each: it
/// goes on through them, and LIGGGHTS stops at triangles that are one and the same.
TriangleMesh without_ends(const TriangleMesh& mesh, int axis, double low, double high);

/// A cylinder of a quarter of the sides, and of the same volume: LIGGGHTS keeps a list of the
/// triangles near each grain, 2000 by default, and those of a rod thinner than the grains are many.
/// @param cylinder  cylinder_surface()
TriangleMesh of_fewer_sides(const TriangleMesh& cylinder);

/// Largest distance of a triangle's corner from the mean of its corners.
double largest_reach(const TriangleMesh& mesh);

/// The walls along z of a block, which stands on a rectangle across z, without its ends: strips of
/// triangles that reach at most so far from their middles, around z = 0.
/// @param block  box_surface() of two corners
/// @param reach  as largest_reach(), positive
TriangleMesh short_walls(const TriangleMesh& block, double reach);

}  // namespace lbm
