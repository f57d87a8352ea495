// SPDX-License-Identifier: MIT
/// A clump on the wire: a carrier, and the spheres that name it.
#pragma once

#include <map>
#include <span>
#include <vector>

#include "protocol/wire/messages.h"

namespace protocol {

/// A sphere of a clump, whose mass, inertia and volume its carrier has.
inline bool is_part(const Shape& shape) {
  return shape.carrier != kItself && shape.carrier != shape.id;
}

/// Of a sphere of a clump its carrier, of anything else kItself.
inline std::int64_t carrier_of(const Shape& shape) {
  return is_part(shape) ? shape.carrier : kItself;
}

/// Holds clumps against their spheres, and both against the box. Its errors name the clump, both
/// values and the interval. @throws BadMessage  exit code 2
class ClumpCheck {
 public:
  /// @param fluid  the fluid's side of what was agreed
  explicit ClumpCheck(const Hello& fluid) : fluid_(fluid) {}

  /// Particles that are not the same ones as an interval before, or some have another shape.
  /// @param particles  in the order of their ids
  /// @param told       ids of those whose shape came now, in order
  void learn(std::span<const Particle> particles, std::span<const std::int64_t> told,
             std::int64_t interval);
  /// Every interval: all spheres lie within their clump's radius.
  void places(std::span<const Particle> particles, std::int64_t interval) const;

  bool none() const { return clumps_.empty(); }
  bool is_clump(std::int64_t id) const { return clumps_.contains(id); }

 private:
  struct Clump {
    std::size_t carrier = 0;  ///< among the particles
    std::vector<std::size_t> spheres;
  };
  using Clumps = std::map<std::int64_t, Clump>;
  Clumps find(std::span<const Particle> particles, std::int64_t interval) const;
  Vec3 arm(const State& sphere, const State& carrier) const;
  void volume(std::span<const Particle> particles, const Clump& clump, std::int64_t interval) const;

  Hello fluid_;
  Clumps clumps_;
};

}  // namespace protocol
