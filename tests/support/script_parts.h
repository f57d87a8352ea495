// SPDX-License-Identifier: GPL-2.0-or-later
/// Parts of LIGGGHTS scripts that tests share; each ends its last line.
#pragma once

#include <string>

namespace test {

/// What a script in three dimensions begins with, up to its box.
inline const std::string kSpheresHead = R"(atom_style granular
atom_modify map array sort 0 0
boundary ${boundary_x} ${boundary_y} ${boundary_z}
newton off
communicate single vel yes
units si
region domain block ${x_lo} ${x_hi} ${y_lo} ${y_hi} ${z_lo} ${z_hi} units box
)";

/// Lists of neighbours and Hertz contacts of spheres of some millimetres.
inline const std::string kHertzContacts = R"(neighbor 0.0005 bin
neigh_modify delay 0
fix m1 all property/global youngsModulus peratomtype 5.e6
fix m2 all property/global poissonsRatio peratomtype 0.45
fix m3 all property/global coefficientRestitution peratomtypepair 1 0.3
fix m4 all property/global coefficientFriction peratomtypepair 1 0.5
pair_style gran model hertz tangential history
pair_coeff * *
timestep ${solid_step}
)";
inline constexpr const char* kHertz = "hertz tangential history";

/// Linear contacts of discs. @param damping  of both directions, over the mass
inline std::string linear_contacts(const std::string& stiffness, const std::string& damping,
                                   const std::string& friction) {
  const auto property = [](const std::string& id, const std::string& name,
                           const std::string& value) {
    return "fix " + id + " all property/global " + name + " peratomtypepair 1 " + value + "\n";
  };
  return property("kn", "kn", stiffness) + property("kt", "kt", stiffness) +
         property("gn", "gamman", damping) + property("gt", "gammat", damping) +
         property("mu", "coefficientFriction", friction) +
         "pair_style gran model hooke/stiffness tangential history\npair_coeff * *\n";
}
inline constexpr const char* kLinear = "hooke/stiffness tangential history";

/// Walls on both sides of the box along each of some axes: fix x and X, y and Y, z and Z.
inline std::string box_walls(const std::string& model, const std::string& axes) {
  std::string walls;
  for (const char axis : axes)
    for (const bool high : {false, true})
      walls += std::string("fix ") + static_cast<char>(high ? axis - 'a' + 'A' : axis) +
               " all wall/gran model " + model + " primitive type 1 " + axis + "plane ${" + axis +
               (high ? "_hi}\n" : "_lo}\n");
  return walls;
}

}  // namespace test
