// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>

#include "lbm_solver/base/simd.h"
#include "lbm_solver/base/vec3.h"

namespace lbm {

/// One number a lane of a SIMD block.
struct alignas(sizeof(Pack)) Lanes : std::array<double, kPackWidth> {};

/// What one solid covers of a SIMD block of a row, and the force that the collision there leaves
/// behind: two cache lines where a block has eight cells. Each body keeps its own in one piece, so
/// that its map and its loads are written and read one after another; only the sweep visits them in
/// its own order.
struct alignas(64) CoverBlock {
  Lanes cover;  ///< solid fraction of each cell, or the number of its CoverKind; 0: fluid
  /// Of the force on the solid, sums over the cells in lattice units: its x and y component, y
  /// times the lane number, z, z times the lane number.
  std::array<double, 5> sums;
  float arm[3];                ///< first cell's centre minus the covering image's; exact (kSnap)
  std::int32_t motion;         ///< of the solid, in the map's list
  CoverBlock* next = nullptr;  ///< what another solid covers of the same SIMD block

  Vec3 force() const { return {sums[0], sums[1], sums[3]}; }
  /// Σ lane number × force; its x component, which moves nothing, is left out.
  Vec3 moment() const { return {0.0, sums[2], sums[4]}; }
};

/// What a covered cell is to its solid: the surface passes through it, it is covered whole, it lies
/// in the core of a body, or in a wall at rest.
enum class CoverKind { Surface, Whole, Core, Wall };

/// How `cover` says so: a surface cell has its solid fraction there, any other the number of its
/// kind.
constexpr double cover_of(CoverKind kind) {
  return static_cast<double>(kind);
}
inline constexpr double kCore = cover_of(CoverKind::Core), kWall = cover_of(CoverKind::Wall);
/// A cell covered to round-off is covered whole.
inline constexpr double kWhole = 1.0 - 1e-12;

/// The kinds of a pack of covered cells, by which a LaneChoice chooses.
template <class V>
[[gnu::always_inline]] inline auto kinds_of(const V& cover) {
  return LaneChoice::which(cover + V(cover_of(CoverKind::Whole) - kWhole));
}

/// Solid fraction of cells, of what a block or several together have in `cover`.
template <class V>
[[gnu::always_inline]] inline V fraction_of(const V& cover) {
  using std::min;
  return min(cover, V(1.0));
}

/// How a solid moves.
struct Motion {
  Vec3 velocity, spin;
};

/// Velocity v + ω × r of a solid's material at the cells of a block; discs turn about z alone.
template <int D, class V>
[[gnu::always_inline]] inline void velocity_in(const CoverBlock& block, const Motion& motion,
                                               V (&u)[D]) {
  const Vec3 &v = motion.velocity, &w = motion.spin;
  const double x = block.arm[0], y = block.arm[1];
  double first[3] = {v.x() - w.z() * y, v.y() + w.z() * x, v.z()};
  if constexpr (D == 3) {
    const double z = block.arm[2];
    first[0] += w.y() * z;
    first[1] -= w.x() * z;
    first[2] += w.x() * y - w.y() * x;
  }
  u[0] = V(first[0]);
  u[1] = V(first[1]) + V(w.z()) * lane_numbers();
  if constexpr (D == 3) u[2] = V(first[2]) - V(w.y()) * lane_numbers();
}

/// Keeps the force on one solid in a block's cells.
template <int D, class V>
[[gnu::always_inline]] inline void keep_force(CoverBlock& block, const V (&f)[D]) {
  const V lane = lane_numbers();
  if constexpr (D == 2)
    store_sums(block.sums.data(), f[0], f[1], lane * f[1]);
  else
    store_sums(block.sums.data(), f[0], f[1], lane * f[1], f[2], lane * f[2]);
}

}  // namespace lbm
