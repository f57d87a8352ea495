// SPDX-License-Identifier: MIT
#include "protocol/wire/walls.h"

#include "protocol/wire/text.h"

namespace protocol {
namespace {

/// "bottom (y = 0 m)"
std::string name_of(const Hello& fluid, int side) {
  static const char* const names[] = {"left", "right", "bottom", "top", "back", "front"};
  const int axis = side / 2;
  return format("{} ({} = {:.6g} m)", names[side], "xyz"[axis],
                side % 2 == 0 ? fluid.box_lo[axis] : fluid.box_hi[axis]);
}

}  // namespace

std::vector<std::string> one_sided_walls(const Hello& fluid, const Hello& solid) {
  std::vector<std::string> found;
  if (!fluid.sides || !solid.sides) return found;
  for (unsigned side = 0; side < 2 * fluid.dimension; ++side) {
    const bool of_fluid = (*fluid.sides)[side] != SideWall::None;
    const bool of_solid = (*solid.sides)[side] != SideWall::None;
    if (of_fluid && !of_solid)
      found.push_back(
          format("side {} is a wall for the fluid, no plane wall of the solid lies there: "
                 "particles that reach it leave the box; if they shall not, add one",
                 name_of(fluid, static_cast<int>(side))));
    if (of_solid && !of_fluid)
      found.push_back(
          format("side {} is a wall for the particles and open for the fluid, as a sieve",
                 name_of(fluid, static_cast<int>(side))));
  }
  for (const std::string& body : solid.bodies)
    found.push_back(
        format("{} is a wall for the particles only: the fluid does not see it and flows "
               "through; if it shall not, add an obstacle to the scene",
               body));
  if (!fluid.bodies.empty() && solid.bodies.empty())
    found.push_back(
        format("{}: there for the fluid only, particles pass through; if they shall not, add "
               "walls to the solid",
               join(fluid.bodies, ", ")));
  return found;
}

}  // namespace protocol
