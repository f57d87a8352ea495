// SPDX-License-Identifier: MIT
#include "protocol/wire/names.h"

#include "protocol/wire/clumps.h"
#include "protocol/wire/text.h"

namespace protocol {

std::string name_of(std::int64_t id, bool is_clump) {
  if (id >= kItself) return format("{} {}", is_clump ? "clump" : "particle", id);
  const std::int64_t count = clump_id(0, 1) - id, family = count >> 32;
  const std::string name = format("clump {}", (count & 0xffffffff) + 1);
  return family == 0 ? name : format("{} of the {}. fix rigid", name, family);
}

std::string name_of(const Shape& shape) {
  const std::string own = name_of(shape.id);
  return is_part(shape) ? format("{} (of {})", own, name_of(shape.carrier, true)) : own;
}

std::string where(const Vec3& place) {
  return format(" at ({:.6g}, {:.6g}, {:.6g}) m", place[0], place[1], place[2]);
}

}  // namespace protocol
