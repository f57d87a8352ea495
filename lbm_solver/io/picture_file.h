// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <string>

#include "lbm_solver/io/image_file.h"

namespace lbm {

/// Pictures by libpng and libtiff, where lbm was built with them.
/// @throws std::invalid_argument  what is wrong with the file, and what to do; or which library lbm
///                                was built without
GreyImage read_png(const std::string& path);
GreyImage read_tiff(const std::string& path);

}  // namespace lbm
