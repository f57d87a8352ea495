// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <string>
#include <vector>

#include "lbm_solver/base/scene.h"

namespace lbm {

/// How deep a ball lies in something of the scene that is no particle.
struct SolidOverlap {
  std::string what;    ///< as a message says it: the 2. obstacle (a mesh), the wall "left"
  double depth = 0.0;  ///< of its surface [m]; beyond its radius: its centre lies inside
  bool moves = false;
  bool keeps = false;       ///< the centre lies inside, from where a surface pushes no way out
  bool on_surface = false;  ///< the centre lies in the surface of a mesh, to round-off
};

/// All that a ball of radius r [m] lies in at a time [s], the deepest first: obstacles where they
/// then are, and the walls of the box. Images are left out: they know no surface.
std::vector<SolidOverlap> solid_overlaps(const Scene& scene, const Vec3& centre, double r,
                                         double time);

}  // namespace lbm
