// SPDX-License-Identifier: MIT
/// Volume of balls that overlap, and how it is spread: what a clump displaces.
#pragma once

#include <array>
#include <span>

#include "protocol/wire/overlap.h"

namespace protocol {

/// Of a union of balls, about the origin of their places.
struct UnionMoments {
  double volume = 0.0;             ///< [m³], of discs of the depth
  Vec3 centroid{};                 ///< [m]
  std::array<double, 6> second{};  ///< means of xx, yy, zz, yz, zx, xy [m²]
};

/// By quadrature: along x each line of a fine grid is integrated exactly, over as much of it as
/// lies in any ball. Of a single ball the formula. Places are not wrapped.
/// @param dimension  2: discs in the plane z = 0, of which only xx, yy and xy count
/// @param depth      of discs [m]
UnionMoments moments_of_union(std::span<const Ball> balls, unsigned dimension, double depth = 1.0);

/// Radius of the ball about the origin that holds them all.
double bounding_radius(std::span<const Ball> balls);

}  // namespace protocol
