// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <string>

#include "lbm_solver/base/scene.h"
#include "lbm_solver/io/table_reader.h"

namespace lbm {

/// Reads a value's factor over time from a table `time,factor` [s, 1] beside the scene.
/// @param key     key that names the table; without it an empty table comes back
/// @param repeat  "once" or "periodic"
/// @throws InputError naming the key, the file and the line
TimeTableScene read_time_table(TableReader& t, const std::string& key, const std::string& repeat,
                               const std::string& scene_file);

}  // namespace lbm
