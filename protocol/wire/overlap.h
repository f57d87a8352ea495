// SPDX-License-Identifier: MIT
/// Particles that lie one in the other, which no contact can have pushed so far.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>

#include "protocol/wire/messages.h"

namespace protocol {

struct Ball {
  std::int64_t id = 0;
  Vec3 x{};             ///< [m]
  double radius = 0.0;  ///< [m]
  bool is_new = true;
  std::int64_t carrier = kItself;  ///< two of one may overlap
};

struct Overlap {
  Ball first, second;
  double distance = 0.0;  ///< of their centres, the shortest over periodic images [m]
};

/// What counts as an overlap: the centre of one inside the other, or surfaces by more than a
/// hundredth of the sum of the radii.
enum class Depth { Centre, Surface };

/// A pair that overlaps, at least one of the two new; nothing where there is none. Grids of one
/// size class each bound the cost: as many steps as there are balls, whatever their sizes and
/// wherever they lie.
/// @param balls  with finite centres and positive radii
/// @param box  its dimension, corners and periodic axes
std::optional<Overlap> find_overlap(std::span<const Ball> balls, const Hello& box,
                                    Depth depth = Depth::Centre);

/// The pair with places and radii in one clause.
std::string describe(const Overlap& pair);

}  // namespace protocol
