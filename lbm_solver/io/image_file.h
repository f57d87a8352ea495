// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <string>
#include <vector>

#include "lbm_solver/base/vec3.h"

namespace lbm {

/// Grey levels of an image, as its file has them.
struct GreyImage {
  Cell3 size{0, 0, 1};        ///< along x, y, z; of a picture z = 1
  std::vector<float> levels;  ///< [z][y][x], y and z upwards

  float& at(int x, int y, int z) {
    return levels[(static_cast<std::size_t>(z) * size[1] + y) * size[0] + x];
  }
};

/// What a file without a header does not say of itself, and where to look in one with many arrays.
struct ImageLayout {
  Cell3 raw_size{0, 0, 0};  ///< x, y, z of a .raw file; x runs fastest
  std::string raw_type;     ///< uint8, int16, … float64, little-endian
  std::string dataset;      ///< path in a .h5 file
};

/// What the end of a file's name says of it, in small letters: ".tif".
std::string image_kind(const std::string& path);

/// Reads .raw, .npy, .h5, .png (grey, 8 or 16 bits) or .tif (grey, one slice a page).
/// Arrays of .npy and .h5 are [z][y][x] or [y][x]. Pictures are taken as they are seen: their first
/// row is the highest y.
/// @throws std::invalid_argument  what is wrong with the file, and what to do
GreyImage read_image(const std::string& path, const ImageLayout& layout);

/// Types of a .raw file.
std::vector<std::string> known_raw_types();

}  // namespace lbm
