// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <string>

#include "lbm_solver/base/scene.h"
#include "lbm_solver/io/table_reader.h"

namespace lbm {

/// Reads the table [fluid] with its [fluid.viscosity].
/// @param d           dimension of the box
/// @param scene_file  path that tables over time are relative to
/// @throws InputError
FluidScene read_fluid(TableReader t, int d, const std::string& scene_file);

/// Settles what depends on more than one table: the viscosity at the typical shear rate, and the
/// place of Smagorinsky's constant.
void settle_viscosity(const TableReader& root, Scene& scene);

}  // namespace lbm
