// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <array>
#include <span>

#include "lbm_solver/base/vec3.h"
#include "lbm_solver/field/esoteric_pull.h"

namespace lbm {

/// Velocity components along a row, [nx] each; z is left alone in two dimensions.
using RowVelocity = std::array<std::span<double>, 3>;

/// Density and velocity of a row of what has arrived, lattice units.
/// @param half_force  half the body force
/// @param rho         [nx]
void row_moments(Populations& f, const EsotericPull& stream, int y, int z, const Vec3& half_force,
                 std::span<double> rho, const RowVelocity& u);

}  // namespace lbm
