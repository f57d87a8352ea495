// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <cstddef>
#include <vector>

#include "lbm_solver/base/vec3.h"

namespace lbm {

/// An image as solid fractions, 0 … 1 a voxel.
struct Voxels {
  Cell3 size{0, 0, 1};       ///< voxels along x, y, z
  std::vector<float> solid;  ///< [z][y][x], from the lower corner

  std::size_t index(int x, int y, int z) const {
    return (static_cast<std::size_t>(z) * size[1] + y) * size[0] + x;
  }
};

}  // namespace lbm
