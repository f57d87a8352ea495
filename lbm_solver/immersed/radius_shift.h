// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include "lbm_solver/base/choices.h"

namespace lbm {

/// What is added to the radius of a disc or sphere before its cells are mapped, in cells: a part
/// that a plane has as well, and one that falls with the radius. Loads, buoyancy and contacts know
/// the true radius only.
struct RadiusShift {
  double plane = 0.0;      ///< thickness added to a solid
  double curvature = 0.0;  ///< radius times radius: added is curvature / radius

  /// @param hollow  the solid lies outside: a thicker one has the smaller radius
  double radius(double r, bool hollow) const {
    return r + (hollow ? -plane : plane) + curvature / r;
  }
};

/// Of a solid collision; none where it has no such correction.
RadiusShift radius_shift(SolidTerm solid_term, int dimension);

}  // namespace lbm
