// SPDX-License-Identifier: MIT
#include "protocol/wire/routing.h"

#include <cmath>

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

}  // namespace protocol
