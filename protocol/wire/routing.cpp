// SPDX-License-Identifier: MIT
#include "protocol/wire/routing.h"

#include <cmath>
#include <unordered_map>

#include "protocol/wire/clumps.h"
#include "protocol/wire/errors.h"
#include "protocol/wire/names.h"
#include "protocol/wire/text.h"

namespace protocol {

bool touches(const Hello& fluid, const Vec3& x, double radius) {
  const double grown = radius + fluid.reach;
  for (unsigned k = 0; k < fluid.dimension; ++k) {
    const double lo = fluid.subdomain_lo[k] - grown, hi = fluid.subdomain_hi[k] + grown;
    double at = x[k];
    if (fluid.periodic[k]) {  // the first image at or above lo is the one to look at
      const double length = fluid.box_hi[k] - fluid.box_lo[k];
      at -= std::floor((at - lo) / length) * length;
    }
    if (at < lo || at > hi) return false;
  }
  return true;
}

bool astray(const Hello& fluid, const Vec3& x) {
  for (unsigned k = 0; k < fluid.dimension; ++k) {
    const double lo = fluid.box_lo[k], hi = fluid.box_hi[k], length = hi - lo;
    if (!fluid.periodic[k] && (x[k] < lo - length || x[k] > hi + length)) return true;
  }
  return false;
}

std::vector<std::size_t> routed_by(std::span<const Shape> shapes) {
  std::vector<std::size_t> by(shapes.size());
  std::unordered_map<std::int64_t, std::size_t> carriers;
  for (std::size_t i = 0; i < shapes.size(); ++i)
    if (!is_part(shapes[i])) carriers.emplace(shapes[i].id, i);
  for (std::size_t i = 0; i < shapes.size(); ++i) {
    by[i] = i;
    if (!is_part(shapes[i])) continue;
    const auto carrier = carriers.find(shapes[i].carrier);
    if (carrier == carriers.end())
      throw ProtocolError(
          format("{} is a sphere of {}, which this rank does not send: the rank that sends a clump "
                 "sends all its spheres",
                 name_of(shapes[i].id), name_of(shapes[i].carrier, true)),
          kBadInput);
    by[i] = carrier->second;
  }
  return by;
}

}  // namespace protocol
