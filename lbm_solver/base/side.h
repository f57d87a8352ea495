// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <array>
#include <string>

namespace lbm {

/// A side of the box: low and high in x, in y, in z.
enum class SideName { Left, Right, Bottom, Top, Back, Front };

/// As a scene names them, in their order; a plane has the first four.
inline const std::array<std::string, 6> kSideNames{"left", "right", "bottom",
                                                   "top",  "back",  "front"};
inline const std::string& name_of(SideName side) {
  return kSideNames[static_cast<int>(side)];
}

/// 0, 1, 2 for x, y, z.
constexpr int axis_of(SideName side) {
  return static_cast<int>(side) / 2;
}
constexpr bool is_high(SideName side) {
  return static_cast<int>(side) % 2 == 1;
}

/// The axes along a side, in the order x, y, z. @param k  0 or 1
constexpr int axis_along(SideName side, int k) {
  return k == 0 ? (axis_of(side) == 0 ? 1 : 0) : (axis_of(side) == 2 ? 1 : 2);
}

}  // namespace lbm
