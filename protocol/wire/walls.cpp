// SPDX-License-Identifier: MIT
#include "protocol/wire/walls.h"

#include "protocol/wire/text.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <optional>

namespace protocol {
namespace {

/// "bottom (y = 0 m)"
std::string name_of(const Hello& fluid, int side) {
  static const char* const names[] = {"left", "right", "bottom", "top", "back", "front"};
  const int axis = side / 2;
  return format("{} ({} = {:.6g} m)", names[side], "xyz"[axis],
                side % 2 == 0 ? fluid.box_lo[axis] : fluid.box_hi[axis]);
}

constexpr const char* kMesh = "mesh from (";

using Extent = std::array<double, 6>;  // lower and upper corner [m]

/// Of the mesh that the name of a body ends with, if it is one.
std::optional<Extent> mesh_in(const std::string& body) {
  const auto at = body.find(kMesh);
  if (at == std::string::npos) return std::nullopt;
  Extent x{};
  const int read =
      std::sscanf(body.c_str() + at + std::strlen(kMesh), "%lf, %lf, %lf) to (%lf, %lf, %lf", &x[0],
                  &x[1], &x[2], &x[3], &x[4], &x[5]);
  return read == 6 ? std::optional(x) : std::nullopt;
}

constexpr const char* kMoving = ", moving";
constexpr const char* kAtRest = ", at rest";

bool ends_with(const std::string& body, const std::string& words) {
  return body.size() >= words.size() &&
         body.compare(body.size() - words.size(), words.size(), words) == 0;
}

/// The name of a body of the solid without where it is and whether it moves.
std::string name_in(const std::string& body) {
  std::string name = body.substr(0, body.find(std::string(", ") + kMesh));
  for (const char* words : {kMoving, kAtRest})
    if (ends_with(name, words)) name.resize(name.size() - std::strlen(words));
  return name;
}

/// One that moves is where it is but for a step's way, and for round-off.
constexpr double kNear = 1e-4;  // of the box

bool same(const Extent& a, const Extent& b, const Hello& box) {
  double size = 0.0;
  for (int k = 0; k < 3; ++k) size = std::max(size, box.box_hi[k] - box.box_lo[k]);
  for (std::size_t k = 0; k < a.size(); ++k)
    if (!(std::abs(a[k] - b[k]) <= kNear * size)) return false;
  return true;
}

/// A cylinder does not tell where it is: one that both have is taken for the same.
bool is_cylinder(const std::string& body) {
  return body.find("(cylinder)") != std::string::npos;
}

/// The bodies of one side that the other has not as the same mesh, or as a cylinder.
std::vector<std::string> unshared(const std::vector<std::string>& mine,
                                  const std::vector<std::string>& others, const Hello& box) {
  std::vector<std::string> rest;
  for (const std::string& body : mine) {
    const auto mesh = mesh_in(body);
    const bool shared = mesh && std::any_of(others.begin(), others.end(), [&](const auto& o) {
                          const auto other = mesh_in(o);
                          return other && same(*mesh, *other, box);
                        });
    const bool round = is_cylinder(body) && std::any_of(others.begin(), others.end(), is_cylinder);
    if (!shared && !round) rest.push_back(body);
  }
  return rest;
}

/// A mesh that both have and one of them moves.
void find_unlike_motion(const Hello& fluid, const Hello& solid, std::vector<std::string>& found) {
  for (const std::string& body : solid.bodies) {
    const auto mesh = mesh_in(body);
    if (!mesh || (!ends_with(body, kMoving) && !ends_with(body, kAtRest))) continue;
    int number = 0, unlike = 0;  // meshes of the fluid; that which is the same and moves otherwise
    bool alike = false;
    for (const std::string& other : fluid.bodies) {
      const auto place = mesh_in(other);
      number += place ? 1 : 0;
      if (!place || !same(*mesh, *place, fluid)) continue;
      if (ends_with(body, kMoving) == ends_with(other, kMoving))
        alike = true;
      else
        unlike = number;
    }
    if (alike || unlike == 0) continue;
    const std::string words = "${mesh" + std::to_string(unlike) + "_motion}";
    if (ends_with(body, kAtRest))
      found.push_back(
          format("{} stands still, and the obstacle of the scene at its place moves: grains and "
                 "fluid will meet two walls; let the script move it, with fix ID all move/mesh "
                 "mesh MESH {}, or where surface_only is given with {} at the end of its fix "
                 "mesh/surface",
                 name_in(body), words, words));
    else
      found.push_back(
          format("{} moves, and the obstacle of the scene at its place stands still: grains and "
                 "fluid will meet two walls; give the obstacle a motion, or leave that of the "
                 "script out",
                 name_in(body)));
  }
}

/// Discs that turn and cylinders that do not. Which of them are one is not known: they are counted.
void find_still_cylinders(const Hello& fluid, const Hello& solid, std::vector<std::string>& found) {
  const auto turning = std::count_if(fluid.bodies.begin(), fluid.bodies.end(), is_cylinder);
  const auto moving = std::count_if(
      solid.bodies.begin(), solid.bodies.end(),
      [](const std::string& body) { return is_cylinder(body) && !ends_with(body, kAtRest); });
  if (moving >= turning) return;
  for (const std::string& body : solid.bodies)
    if (is_cylinder(body) && ends_with(body, kAtRest))
      found.push_back(format(
          "{} stands still, and a disc of the scene turns: if they are one wall, take the words of "
          "{}, whose shear turns it",
          name_in(body), "${disc1_wall}"));
}

}  // namespace

std::string motion_text(bool moves) {
  return moves ? kMoving : kAtRest;
}

std::string mesh_text(const Vec3& low, const Vec3& high) {
  return format("{}{:.6g}, {:.6g}, {:.6g}) to ({:.6g}, {:.6g}, {:.6g}) m", kMesh, low[0], low[1],
                low[2], high[0], high[1], high[2]);
}

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
  const auto of_fluid = unshared(fluid.bodies, solid.bodies, fluid);
  for (const std::string& body : unshared(solid.bodies, fluid.bodies, fluid))
    found.push_back(
        format("{} is a wall for the particles only: the fluid does not see it and flows "
               "through; if it shall not, add an obstacle to the scene",
               name_in(body)));
  if (!of_fluid.empty() && solid.bodies.empty())
    found.push_back(
        format("{}: there for the fluid only, particles pass through; if they shall not, add "
               "walls to the solid",
               join(of_fluid, ", ")));
  find_unlike_motion(fluid, solid, found);
  find_still_cylinders(fluid, solid, found);
  return found;
}

}  // namespace protocol
