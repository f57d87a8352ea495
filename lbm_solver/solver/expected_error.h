// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <optional>
#include <string>

namespace lbm {

/// Error to expect of the drag on bodies, in per cent, signed: that of a regular array with the
/// same solid fraction, interpolated in a table that `scheme_report --arrays` makes. It does not
/// depend on the relaxation time where cells collide by resistance; the table of the other terms is
/// for τ = 1.
/// @param solid_term  of the kernel; nothing where the table does not have it
/// @param fraction    solid fraction of the bed, 0..1; taken at the table's ends beyond them
/// @param diameter    cells a diameter
std::optional<double> expected_error(const std::string& solid_term, int dimension, double fraction,
                                     double diameter);

/// Solid fractions of a loose and of a dense bed, where a scene does not give its own.
inline constexpr double kLooseBed[] = {0.2, 0.125}, kDenseBed[] = {0.4, 0.343};  // 2D, 3D

}  // namespace lbm
