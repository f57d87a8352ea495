// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <optional>
#include <string>

#include "lbm_solver/base/motion.h"
#include "lbm_solver/io/table_reader.h"

namespace lbm {

/// How an obstacle moves, where its table says so. `about` is left to the caller where it is
/// absent.
struct ReadMotion {
  MotionScene motion;
  bool has_pivot = false;
};

/// @param scene_file  whose folder a table's name is relative to
/// @throws InputError
std::optional<ReadMotion> read_motion(TableReader& table, const std::string& scene_file,
                                      int dimension);

}  // namespace lbm
