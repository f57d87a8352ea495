// SPDX-License-Identifier: GPL-2.0-or-later
#include "liggghts_coupling/host/solid_walls.h"

#include <atom.h>
#include <error.h>
#include <fix_mesh_surface.h>
#include <fix_wall_gran.h>
#include <fmt/core.h>
#include <modify.h>
#include <primitive_wall.h>
#include <tri_mesh.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "liggghts_coupling/host/coupling.h"
#include "liggghts_coupling/host/covered_side.h"
#include "protocol/wire/walls.h"

namespace dem {
namespace {

using protocol::Hello;

constexpr double kNear = 1e-3;  // of the box's length: the same place
constexpr double kHalf = 0.5;   // of the box's length: so far a side without particles is looked at

struct Plane {
  int axis = 0;
  double place = 0.0;  ///< [m]
};

/// Where a wall without a mesh lies, if it is a plane: from the middle of the box the way to it
/// runs along one axis; to a cylinder about that axis it runs across. (LIGGGHTS does not tell its
/// kind.)
std::optional<Plane> plane_of(LAMMPS_NS::PrimitiveWall& wall, const Hello& box) {
  if (wall.axis() >= 0) return std::nullopt;  // the axis of a cylinder
  double middle[3], way[3];
  for (int k = 0; k < 3; ++k)  // off the middle, where a plane may lie
    middle[k] = box.box_lo[k] + 0.4871 * (box.box_hi[k] - box.box_lo[k]);
  wall.resolveContact(middle, 0.0, way);
  for (int k = 0; k < 3; ++k)
    if (way[k] != 0.0) return Plane{k, middle[k] + way[k]};
  return std::nullopt;
}

/// @return whether the plane is a side of the box
bool mark_side(const Plane& plane, Hello& hello) {
  const auto [k, place] = plane;
  const double near = kNear * (hello.box_hi[k] - hello.box_lo[k]);
  const bool low = std::abs(place - hello.box_lo[k]) <= near;
  if (!low && std::abs(place - hello.box_hi[k]) > near) return false;
  (*hello.sides)[2 * k + (low ? 0 : 1)] = protocol::SideWall::Whole;
  return true;
}

struct Extent {
  protocol::Vec3 low, high;
};

/// The box around a mesh, of all ranks.
Extent extent_of(LAMMPS_NS::TriMesh& mesh, MPI_Comm ranks) {
  constexpr double far = std::numeric_limits<double>::infinity();
  std::array<double, 6> most;  // of x, y, z and of -x, -y, -z
  most.fill(-far);
  for (int t = 0; t < mesh.sizeLocal(); ++t)
    for (int corner = 0; corner < mesh.numNodes(); ++corner) {
      double x[3];
      mesh.node_slow(t, corner, x);
      for (int k = 0; k < 3; ++k) {
        most[k] = std::max(most[k], x[k]);
        most[3 + k] = std::max(most[3 + k], -x[k]);
      }
    }
  MPI_Allreduce(MPI_IN_PLACE, most.data(), 6, MPI_DOUBLE, MPI_MAX, ranks);
  for (double& m : most) m += 0.0;  // no -0
  return {{0.0 - most[3], 0.0 - most[4], 0.0 - most[5]}, {most[0], most[1], most[2]}};
}

/// Whether a side of the box is a wall of the fluid.
bool is_fluids(int side, const Hello& fluid) {
  return fluid.sides && (*fluid.sides)[side] != protocol::SideWall::None;
}

/// Whether a mesh is flat and lies in a side of the box that is a wall of the fluid.
bool lies_in_side(const Extent& mesh, const Hello& fluid) {
  for (unsigned k = 0; k < fluid.dimension; ++k) {
    const double near = kNear * (fluid.box_hi[k] - fluid.box_lo[k]);
    for (const bool high : {false, true}) {
      const double side = high ? fluid.box_hi[k] : fluid.box_lo[k];
      if (std::abs(mesh.low[k] - side) <= near && std::abs(mesh.high[k] - side) <= near)
        return is_fluids(static_cast<int>(2 * k) + (high ? 1 : 0), fluid);
    }
  }
  return false;
}

/// From each side of the box to the surface of the first particle [m], of all ranks; half of the
/// box where there is none yet.
std::array<double, 6> free_depths(LAMMPS_NS::LAMMPS& lammps, const Hello& box) {
  std::array<double, 6> depth;
  for (int side = 0; side < 6; ++side)
    depth[side] = kHalf * (box.box_hi[side / 2] - box.box_lo[side / 2]);
  if (lammps.atom->natoms == 0) return depth;
  depth.fill(std::numeric_limits<double>::infinity());
  for (int i = 0; i < lammps.atom->nlocal; ++i)
    for (int k = 0; k < 3; ++k) {
      const double x = lammps.atom->x[i][k], r = lammps.atom->radius[i];
      depth[2 * k] = std::min(depth[2 * k], x - r - box.box_lo[k]);
      depth[2 * k + 1] = std::min(depth[2 * k + 1], box.box_hi[k] - x - r);
    }
  MPI_Allreduce(MPI_IN_PLACE, depth.data(), 6, MPI_DOUBLE, MPI_MIN, lammps.world);
  return depth;
}

/// Marks the fluid's walls that no particle can come to for meshes that stay where they are.
void mark_covered_sides(const std::vector<LAMMPS_NS::TriMesh*>& meshes, LAMMPS_NS::LAMMPS& lammps,
                        const Hello& fluid, Hello& hello) {
  const std::array<double, 6> depth = free_depths(lammps, hello);
  for (int side = 0; side < static_cast<int>(2 * hello.dimension); ++side) {
    if ((*hello.sides)[side] != protocol::SideWall::None || !is_fluids(side, fluid)) continue;
    const int k = side / 2;
    CoveredSide cover(hello.box_lo, hello.box_hi, static_cast<int>(hello.dimension), side,
                      depth[side], kNear * (hello.box_hi[k] - hello.box_lo[k]));
    for (LAMMPS_NS::TriMesh* mesh : meshes)
      for (int t = 0; t < mesh->sizeLocal(); ++t) {
        std::array<Place, 3> corners;
        for (int corner = 0; corner < 3; ++corner)
          mesh->node_slow(t, corner, corners[corner].data());
        cover.add(corners);
      }
    std::vector<int>& met = cover.met();
    MPI_Allreduce(MPI_IN_PLACE, met.data(), static_cast<int>(met.size()), MPI_INT, MPI_MAX,
                  lammps.world);
    if (cover.covered()) (*hello.sides)[side] = protocol::SideWall::Whole;
  }
}

/// @param at_rest  gets the meshes that stay where they are
void tell_granular_wall(LAMMPS_NS::FixWallGran& fix, MPI_Comm ranks, const Hello& fluid,
                        Hello& hello, std::vector<LAMMPS_NS::TriMesh*>& at_rest) {
  if (fix.is_mesh_wall()) {
    for (int m = 0; m < fix.n_meshes(); ++m) {
      auto* const mesh = fix.mesh_list()[m];
      const bool moves = mesh->triMesh()->isMoving() || mesh->surfaceVel();
      const Extent extent = extent_of(*mesh->triMesh(), ranks);
      if (!mesh->triMesh()->isMoving()) at_rest.push_back(mesh->triMesh());
      if (!moves && lies_in_side(extent, fluid)) continue;
      hello.bodies.push_back(
          fmt::format("fix {} {} (of fix {} {}), {}{}", mesh->id, mesh->style, fix.id, fix.style,
                      protocol::mesh_text(extent.low, extent.high), protocol::motion_text(moves)));
    }
    return;
  }
  const auto plane = plane_of(*fix.primitiveWall(), hello);
  if (plane && mark_side(*plane, hello)) return;
  const std::string what =
      plane ? fmt::format("plane {} = {:.6g} m", "xyz"[plane->axis], plane -> place)
            : std::string("cylinder");
  hello.bodies.push_back(fmt::format("fix {} {} ({}){}", fix.id, fix.style, what,
                                     plane ? "" : protocol::motion_text(fix.is_moving() != 0)));
}

}  // namespace

void tell_walls(LAMMPS_NS::LAMMPS& lammps, Hello& hello) {
  hello.sides.emplace();
  hello.bodies.clear();
  const Hello& fluid = Coupling::instance().session->fluid();
  std::vector<LAMMPS_NS::TriMesh*> at_rest;
  for (int i = 0; i < lammps.modify->nfix; ++i) {
    LAMMPS_NS::Fix* fix = lammps.modify->fix[i];
    const std::string style = fix->style;
    if (auto* granular = dynamic_cast<LAMMPS_NS::FixWallGran*>(fix))
      tell_granular_wall(*granular, lammps.world, fluid, hello, at_rest);
    else if (style.starts_with("wall/"))
      hello.bodies.push_back(fmt::format("fix {} {}", fix->id, style));
  }
  if (!at_rest.empty()) mark_covered_sides(at_rest, lammps, fluid, hello);
}

}  // namespace dem
