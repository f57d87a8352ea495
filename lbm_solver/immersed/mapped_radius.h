// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include "lbm_solver/immersed/radius_shift.h"

namespace lbm {

/// Radius with which a disc or sphere is mapped, in cells. The shift is known of bodies that are at
/// least two cells wide (docs/resistance.md); of smaller ones it falls with the radius.
inline double mapped_radius(const RadiusShift& shift, double radius, bool hollow) {
  return radius < 1.0 ? radius * shift.radius(1.0, hollow) : shift.radius(radius, hollow);
}

}  // namespace lbm
