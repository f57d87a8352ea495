// SPDX-License-Identifier: GPL-2.0-or-later
#include "lbm_solver/solver/side_loads.h"

#include <map>

namespace lbm {
namespace {

/// The patch that replaces what enters a cell along q, and the number of its link.
struct Owner {
  const Patch* patch;
  std::size_t link;
};
using Owners = std::map<std::array<int, 4>, Owner>;  // by cell and q

Owners owners_of(const Fluid& fluid) {
  Owners found;
  for (const auto& patch : fluid.patches())
    for (std::size_t i = 0; i < patch->links().size(); ++i) {
      const Link& link = patch->links()[i];
      found[{link.cell[0], link.cell[1], link.cell[2], link.q}] = {patch.get(), i};
    }
  return found;
}

/// -c_q without what belongs to other walls that the link crosses too.
Vec3 part_of_side(const Fluid& fluid, const Cell3& cell, int q, int axis) {
  Vec3 weight = -velocity_of(fluid.lattice(), q);
  for (int k = 0; k < fluid.lattice().D; ++k) {
    const int from = cell[k] + fluid.cells().begin[k] - fluid.lattice().c[q][k];
    const bool outside = from < 0 || from >= fluid.domain().cells()[k];
    if (k != axis && outside && fluid.domain().sides()[k] == Side::Wall) weight[k] = 0.0;
  }
  return weight;
}

}  // namespace

SideLoads::SideLoads(const Fluid& fluid, SideName side) {
  const int axis = axis_of(side), inward = is_high(side) ? -1 : 1;
  const Block& mine = fluid.cells();
  if (fluid.domain().sides()[axis] == Side::Periodic) return;
  const int layer = (is_high(side) ? fluid.domain().cells()[axis] - 1 : 0) - mine.begin[axis];
  if (layer < 0 || layer >= mine.size[axis]) return;
  const Owners owners = owners_of(fluid);
  Cell3 begin{0, 0, 0}, end = mine.size;
  begin[axis] = layer;
  end[axis] = layer + 1;
  for (int z = begin[2]; z < end[2]; ++z)
    for (int y = begin[1]; y < end[1]; ++y)
      for (int x = begin[0]; x < end[0]; ++x)
        for (int q = 1; q < fluid.lattice().Q; ++q) {
          if (fluid.lattice().c[q][axis] != inward) continue;
          Wall wall{{x, y, z}, q, part_of_side(fluid, {x, y, z}, q, axis)};
          if (const auto owner = owners.find({x, y, z, q}); owner != owners.end()) {
            wall.moving = dynamic_cast<const VelocityPatch*>(owner->second.patch);
            wall.link = owner->second.link;
            if (!wall.moving) continue;
          }
          walls_.push_back(wall);
        }
}

Vec3 SideLoads::force(const Fluid& fluid) const {
  Vec3 sum = Vec3::Zero();
  for (const Wall& wall : walls_) {
    const auto& [x, y, z] = wall.cell;
    double both = 2.0 * fluid.arriving(wall.q, x, y, z);
    if (wall.moving) both -= wall.moving->added(wall.link, fluid.steps() - 1);
    sum += both * wall.weight;
  }
  return sum;
}

}  // namespace lbm
