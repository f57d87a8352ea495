// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <nlohmann/json.hpp>

namespace lbm {

/// Error of the drag of arrays of discs and spheres in Stokes flow, by solid fraction and cells a
/// diameter: the default solid collisions and those that were the default before, at τ = 1; one
/// array at other relaxation times; discs that move through the lattice. Prints tables.
/// @return "rest": a row an array: body, solid_term, fraction, tau, cells (a period), diameter (in
///         cells), error_percent and spread_percent (mean and range over places of the body in a
///         cell); "moving": the same with sigma_percent, of the force over the passage of cells
nlohmann::json array_table();

}  // namespace lbm
