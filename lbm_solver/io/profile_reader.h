// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <string>

#include "lbm_solver/base/scene.h"
#include "lbm_solver/io/table_reader.h"

namespace lbm {

/// The factor of a velocity along a side: key `profile_table` of its table, the name of a file
/// beside the scene. Its first line names axes of the side, and factor: y,factor of the left side;
/// in three dimensions also z,factor and y,z,factor. Its lines are a grid of these axes, in any
/// order. None where the key is not given.
/// @throws InputError
ProfileScene read_profile(TableReader& boundary, SideName side, int dimension,
                          const std::string& scene_file);

}  // namespace lbm
