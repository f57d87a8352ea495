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

}  // namespace

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
               body.substr(0, body.find(std::string(", ") + kMesh))));
  if (!of_fluid.empty() && solid.bodies.empty())
    found.push_back(
        format("{}: there for the fluid only, particles pass through; if they shall not, add "
               "walls to the solid",
               join(of_fluid, ", ")));
  return found;
}

}  // namespace protocol
