// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <cstdint>

#include "lbm_solver/base/units.h"

namespace lbm {

/// A rigid disc as the lattice sees it, in lattice units.
struct Disc {
  std::int64_t id = 0;
  Vec2 centre{0.0, 0.0};
  double radius = 0.0;
  Vec2 velocity{0.0, 0.0};
  double spin = 0.0;    ///< [rad / step]
  bool hollow = false;  ///< the solid is everything outside of the circle
};

/// Force and torque on a disc about its centre, lattice units.
struct DiscLoad {
  Vec2 force{0.0, 0.0};
  double torque = 0.0;
};

}  // namespace lbm
