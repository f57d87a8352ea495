// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <string>
#include <vector>

#include "lbm_solver/base/scene.h"
#include "lbm_solver/io/table_reader.h"

namespace lbm {

/// Reads [grains]: discs or spheres at rest from a table `x,y,diameter` or `x,y,z,diameter` [m]
/// beside the scene, one obstacle a line.
/// @throws InputError naming the file and the line
void read_grains(TableReader t, const std::string& scene_file, int d,
                 std::vector<ObstacleScene>& obstacles);

}  // namespace lbm
