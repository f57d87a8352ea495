// SPDX-License-Identifier: MIT
#pragma once

#include <span>
#include <vector>

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

/// Of each record the one whose ball says which fluid ranks get it: itself, or its clump's carrier.
/// @throws ProtocolError  a sphere of a clump comes without its carrier
std::vector<std::size_t> routed_by(std::span<const Shape> shapes);

}  // namespace protocol
