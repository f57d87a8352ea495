// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

namespace lbm {

/// The numbers of a collision, lattice units. An operator takes those it knows.
struct CollisionParameters {
  double tau = 1.0;           ///< relaxation time of the viscosity, nu = (tau - 1/2)/3
  double magic = 3.0 / 16.0;  ///< Λ of TRT
  double smagorinsky = 0.0;   ///< constant S_c times the filter width in cells
  double force_x = 0.0, force_y = 0.0, force_z = 0.0;  ///< body force on a cell
};

}  // namespace lbm
