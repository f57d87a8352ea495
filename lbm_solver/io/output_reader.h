// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include "lbm_solver/base/scene.h"
#include "lbm_solver/io/table_reader.h"

namespace lbm {

/// Reads [output], [average] and every [[sensor]] of a scene.
/// @param root  the whole scene
/// @throws InputError
OutputScene read_output(TableReader& root, const BoxScene& box);

}  // namespace lbm
