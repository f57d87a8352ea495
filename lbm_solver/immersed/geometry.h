// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <functional>
#include <memory>
#include <span>
#include <variant>

#include "lbm_solver/base/triangle_mesh.h"
#include "lbm_solver/base/voxels.h"
#include "lbm_solver/field/domain.h"
#include "lbm_solver/immersed/radius_shift.h"

namespace lbm {

/// A disc or sphere; hollow: everything outside of it. Lengths and places in cells of the box, as
/// everywhere below.
struct Ball {
  Vec3 centre;
  double radius = 0.0;
  bool hollow = false;
};

/// Cells [from, to) of the box.
struct CellBox {
  Cell3 from{0, 0, 0}, to{0, 0, 1};

  bool holds(const Cell3& c) const {
    for (int a = 0; a < 3; ++a)
      if (c[a] < from[a] || c[a] >= to[a]) return false;
    return true;
  }
  Vec3 centre() const {
    Vec3 middle;
    for (int a = 0; a < 3; ++a) middle[a] = 0.5 * (from[a] + to[a]);
    return middle;
  }
};

/// What a closed surface encloses; hollow: everything outside of it.
struct MeshSolid {
  std::shared_ptr<const TriangleMesh> mesh;  ///< vertices in cells of the box
  bool hollow = false;
};

/// The voxels of an image, each `finer` cells wide, or `coarser` of them to a cell: one of the two
/// is 1.
struct VoxelSolid {
  std::shared_ptr<const Voxels> voxels;
  Cell3 at{0, 0, 0};  ///< cell of the box in which the first voxel lies
  int finer = 1, coarser = 1;

  /// Cells that it takes along an axis.
  int cells(int axis) const { return voxels->size[axis] * finer / coarser; }
};

/// The shape of a solid.
struct Geometry {
  std::variant<Ball, CellBox, MeshSolid, VoxelSolid> shape;

  /// About which torques are counted: the middle of what bounds it.
  Vec3 centre() const;
};

/// Cells of a row that a solid covers, side by side.
struct FractionSpan {
  int x, y, z;  ///< of the first one, among the rank's cells
  std::span<const double> fractions;
};

/// Calls `take` with spans of solid fractions, at most one a row and image of the solid, in the
/// order of the rows. Balls cover images across periodic sides too, the others are cut there.
/// Fractions of a mesh are exact to round-off where the surface does not pass through itself.
/// @param cells  of the rank
/// @param shift  of curved surfaces
/// @throws std::invalid_argument  a mesh does not say what is inside
void fill(const Geometry& geometry, const Domain& domain, const Block& cells,
          const RadiusShift& shift, const std::function<void(const FractionSpan&)>& take);

}  // namespace lbm
