// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <functional>
#include <vector>

#include "lbm_solver/immersed/geometry.h"

namespace lbm {

/// Solid fractions of what a closed surface encloses, exact to round-off. Along x a place is inside
/// once for each triangle behind it that faces back, less those that face forward, so with n_x dA
/// the part of a triangle that is seen along x,
///   ε = Σ over the triangles ∫ -n_x clamp(x_end - x, 0, 1) dA
/// in the cell that ends at x_end: each triangle is cut into the pieces that lie in one cell, gives
/// that cell the volume behind it, and all cells of the row beyond a whole column. No ray is shot
/// and no place is asked whether it lies inside.
/// @param mesh   vertices in cells of the box; closed, and running counter-clockwise seen from
///               outside
/// @param shift  the layer plane + curvature × mean curvature is added to cells that the surface
///               passes through: RadiusShift for a surface of any shape
/// @throws std::invalid_argument  somewhere the surface encloses less than nothing
void fill_mesh(const TriangleMesh& mesh, bool hollow, const Block& cells, const RadiusShift& shift,
               const std::function<void(const FractionSpan&)>& take);
/// Likewise. @param bend  mean_curvatures of the mesh, which stay what they are where it moves
void fill_mesh(const TriangleMesh& mesh, const std::vector<double>& bend, bool hollow,
               const Block& cells, const RadiusShift& shift,
               const std::function<void(const FractionSpan&)>& take);

}  // namespace lbm
