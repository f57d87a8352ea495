// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <optional>

#include "lbm_solver/base/scene.h"
#include "lbm_solver/solver/kernel.h"

namespace lbm {

struct ExpectedError {
  double percent = 0.0;   ///< of the drag, signed
  bool at_least = false;  ///< smaller, or more packed, than the table: the error is larger
};

/// Error to expect of the drag on bodies: that of slow flow through a regular array with the same
/// solid fraction, interpolated in a table that `scheme_report --arrays` makes. It does not depend
/// on the relaxation time where cells collide by resistance; that of Holdych's terms is for τ = 1.
/// Central moments with layered Noble–Torczynski have a table over τ for discs of solid fraction
/// 0.2 (cases/cylinder_array), whatever the fraction.
/// @param kernel    its operator, term, τ and Λ; nothing where there is no table for them
/// @param fraction  solid fraction of the bed, 0..1
/// @param diameter  cells a diameter
std::optional<ExpectedError> expected_error(const KernelChoice& kernel, int dimension,
                                            double fraction, double diameter);

struct Plan;
/// Puts into a plan what its drag will be off by, and a warning where that is much. Not of bodies
/// in a flow that is not slow, or in a shell: that is no array.
void expect_error(const Scene& scene, Plan& plan);

/// Λ of TRT that puts a half-way wall half-way.
inline constexpr double kHalfWayMagic = 3.0 / 16.0;

/// Solid fractions of a loose and of a dense bed, where a scene does not give its own: the dense
/// one has open pores. Grains touch at the third.
inline constexpr double kLooseBed[] = {0.2, 0.125}, kDenseBed[] = {0.5, 0.5236},
                        kPackedBed[] = {0.8, 0.6};  // 2D, 3D

}  // namespace lbm
