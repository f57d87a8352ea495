// SPDX-License-Identifier: MIT
#pragma once

#include "protocol/wire/messages.h"

namespace protocol {

/// Does a particle act on the subdomain of the fluid rank that sent `fluid`, itself or as a
/// periodic image? Positions may lie outside the box: an engine wraps when it likes.
/// @param x       centre [m]
/// @param radius  [m]; the fluid's reach is added
bool touches(const Hello& fluid, const Vec3& x, double radius);

/// Is a place farther outside of the box than that is long, on an axis that is not periodic? A
/// particle that leaves an open box is dropped long before.
bool astray(const Hello& fluid, const Vec3& x);

}  // namespace protocol
