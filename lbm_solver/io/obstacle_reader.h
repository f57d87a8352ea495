// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <string>

#include "lbm_solver/base/scene.h"
#include "lbm_solver/io/table_reader.h"

namespace lbm {

/// An obstacle: a disc or sphere, a block, or what a file beside the scene holds. A mesh is placed,
/// and refused where it does not say what is inside; of an image's levels solid fractions are made.
/// @param scene_file  whose folder file names are relative to
/// @throws InputError
ObstacleScene read_obstacle(TableReader table, const std::string& scene_file, const BoxScene& box);

}  // namespace lbm
