// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

namespace lbm {

/// D2Q9: velocities c, weights w, speed of sound c_s² = 1/3.
/// Direction 0 rests; (1,2), (3,4), (5,6), (7,8) are opposite pairs, the first of each pointing to
/// +x, or to +y along the y axis. In-place streaming relies on that order.
struct D2Q9 {
  static constexpr int Q = 9;
  static constexpr int pairs = 4;
  static constexpr int c[Q][2] = {{0, 0}, {1, 0},   {-1, 0}, {0, 1}, {0, -1},
                                  {1, 1}, {-1, -1}, {1, -1}, {-1, 1}};
  static constexpr double w[Q] = {4.0 / 9,  1.0 / 9,  1.0 / 9,  1.0 / 9, 1.0 / 9,
                                  1.0 / 36, 1.0 / 36, 1.0 / 36, 1.0 / 36};
  static constexpr int opposite(int i) { return i == 0 ? 0 : ((i - 1) ^ 1) + 1; }
};

}  // namespace lbm
