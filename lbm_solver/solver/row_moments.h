// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <array>
#include <span>

#include "lbm_solver/base/vec3.h"
#include "lbm_solver/field/esoteric_pull.h"
#include "lbm_solver/immersed/cover_map.h"
#include "lbm_solver/immersed/solid_share.h"
#include "lbm_solver/viscosity/eddy_field.h"

namespace lbm {

/// Velocity components along a row, [nx] each; z is left alone in two dimensions.
using RowVelocity = std::array<std::span<double>, 3>;

/// What the moments of a row depend on beside the populations.
struct RowMedium {
  CollisionParameters parameters;     ///< half of the body force belongs to the momentum
  bool local_viscosity = false;       ///< the relaxation time depends on the shear rate
  const CoverMap* cover = nullptr;    ///< covered cells; null: none
  SolidShare share;                   ///< of the solids in their velocity
  const EddyField* eddies = nullptr;  ///< null: none
};

/// Density of a row of what has arrived, and its velocity, in covered cells (1-B) u + B u_s.
/// Lattice units. Populations that are not finite make both not finite, in covered cells too.
/// @param rho     [nx]
/// @param solid   [nx], B: 0 in fluid, 1 where a cell is covered whole
void row_moments(Populations& f, const EsotericPull& stream, int y, int z, const RowMedium& medium,
                 std::span<double> rho, const RowVelocity& u, std::span<double> solid);

}  // namespace lbm
