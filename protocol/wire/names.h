// SPDX-License-Identifier: MIT
/// What messages call a particle.
#pragma once

#include <cstdint>
#include <string>

#include "protocol/wire/messages.h"

namespace protocol {

/// Ids of bodies that a solid counts apart from its particles lie below that which says "itself".
/// @param family  0 where there is one count of them; else which of those that there are
/// @param number  from 1 on
constexpr std::int64_t clump_id(std::int64_t family, std::int64_t number) {
  return kItself - (family << 32) - number;
}

/// "particle 7"; of an id that clump_id gives "clump 2", "clump 2 of the 1. fix rigid".
/// @param is_clump  an id that is no such one is a clump's too: "clump 7"
std::string name_of(std::int64_t id, bool is_clump = false);

/// Likewise; of a clump's sphere "particle 7 (of clump 2)".
std::string name_of(const Shape& shape);

/// " at (0.1, 0.2, 0) m"
std::string where(const Vec3& place);

}  // namespace protocol
