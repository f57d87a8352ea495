// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <algorithm>
#include <cmath>
#include <experimental/simd>

namespace lbm {

/// Part of a unit cell's length that a body's chord covers.
/// @param along  place of the cell's centre from the middle of the chord
/// @param rest   radius² minus the square of the chord's distance from the centre
template <class V>
[[gnu::always_inline]] inline V covered_length(const V& along, const V& rest) {
  using std::max, std::min, std::sqrt;
  const V half = sqrt(max(rest, V(0.0))), half_cell(0.5);
  // the chord spans [-half, half], the cell [along - 1/2, along + 1/2]
  return max(V(0.0), min(half, along + half_cell) - max(-half, along - half_cell));
}

inline constexpr double kGaussPoint = 0.28867513459481287;  // 1 / (2 √3), of a unit cell

/// Fraction of a unit cell that a disc covers: the disc's chord along the axis that is nearer to
/// the normal, at the two Gauss points across it. Root-mean-square error 0.006 at ten cells a
/// diameter (5×5 sample points: 0.021, at the same cost).
/// @param dx, dy  cell centre minus disc centre, in cells
/// @param radius  in cells
template <class V>
[[gnu::always_inline]] inline V disc_fraction(const V& dx, const V& dy, double radius) {
  using std::abs, std::max, std::min;
  const V along = max(abs(dx), abs(dy)), across = min(abs(dx), abs(dy)), r2(radius * radius);
  const V low = across - V(kGaussPoint), high = across + V(kGaussPoint);
  return V(0.5) *
         (covered_length<V>(along, r2 - low * low) + covered_length<V>(along, r2 - high * high));
}

/// The same of a sphere: chords at the two by two Gauss points across the axis.
/// @param dx, dy, dz  cell centre minus sphere centre, in cells
template <class V>
[[gnu::always_inline]] inline V sphere_fraction(const V& dx, const V& dy, const V& dz,
                                                double radius) {
  using std::abs, std::max, std::min;
  const V longer = max(abs(dx), abs(dy)), p = min(abs(dx), abs(dy));
  const V along = max(longer, abs(dz)), q = min(longer, abs(dz)), r2(radius * radius);
  const V low_p = p - V(kGaussPoint), high_p = p + V(kGaussPoint);
  const V low_q = q - V(kGaussPoint), high_q = q + V(kGaussPoint);
  const V near = r2 - low_p * low_p, far = r2 - high_p * high_p;
  return V(0.25) * (covered_length<V>(along, near - low_q * low_q) +
                    covered_length<V>(along, near - high_q * high_q) +
                    covered_length<V>(along, far - low_q * low_q) +
                    covered_length<V>(along, far - high_q * high_q));
}

}  // namespace lbm
