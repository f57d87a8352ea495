// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <memory>

namespace lbm {

class RelaxationTable;

/// The numbers of a collision, lattice units. An operator takes those it knows.
struct CollisionParameters {
  double tau = 1.0;           ///< relaxation time of the viscosity, nu = (tau - 1/2)/3; where that
                              ///< depends on the shear rate, of a typical one
  double magic = 3.0 / 16.0;  ///< Λ of TRT
  double smagorinsky = 0.0;   ///< constant S_c times the filter width in cells
  double force_x = 0.0, force_y = 0.0, force_z = 0.0;  ///< body force on a cell
  /// Relaxation time as a function of the stress; null: tau, or Smagorinsky's
  std::shared_ptr<const RelaxationTable> viscosity_table = nullptr;
  /// That of cells which a solid covers in part; null: the same
  std::shared_ptr<const RelaxationTable> covered_table = nullptr;
};

}  // namespace lbm
