// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <string>

#include "lbm_solver/base/scene.h"
#include "lbm_solver/io/table_reader.h"

namespace lbm {

/// Reads one [[boundary]]: a boundary condition on a side of the box or on a part of it.
/// @param scene_file  path that tables over time are relative to
/// @throws InputError
BoundaryScene read_boundary(TableReader t, const BoxScene& box, const std::string& scene_file);

}  // namespace lbm
