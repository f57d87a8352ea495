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

#include "protocol/wire/walls.h"

namespace dem {
namespace {

using protocol::Hello;

constexpr double kNear = 1e-3;  // of the box's length: the same place

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

/// The box around a mesh, of all ranks.
std::string extent_text(LAMMPS_NS::TriMesh& mesh, MPI_Comm ranks) {
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
  return protocol::mesh_text({0.0 - most[3], 0.0 - most[4], 0.0 - most[5]},
                             {most[0], most[1], most[2]});
}

void tell_granular_wall(LAMMPS_NS::FixWallGran& fix, MPI_Comm ranks, Hello& hello) {
  if (fix.is_mesh_wall()) {
    for (int m = 0; m < fix.n_meshes(); ++m) {
      auto* const mesh = fix.mesh_list()[m];
      const bool moves = mesh->triMesh()->isMoving() || mesh->surfaceVel();
      hello.bodies.push_back(fmt::format("fix {} {} (of fix {} {}), {}{}", mesh->id, mesh->style,
                                         fix.id, fix.style, extent_text(*mesh->triMesh(), ranks),
                                         protocol::motion_text(moves)));
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
  for (int i = 0; i < lammps.modify->nfix; ++i) {
    LAMMPS_NS::Fix* fix = lammps.modify->fix[i];
    const std::string style = fix->style;
    if (auto* granular = dynamic_cast<LAMMPS_NS::FixWallGran*>(fix))
      tell_granular_wall(*granular, lammps.world, hello);
    else if (style.starts_with("wall/"))
      hello.bodies.push_back(fmt::format("fix {} {}", fix->id, style));
  }
}

}  // namespace dem
