// SPDX-License-Identifier: MIT
#pragma once

#include <string>
#include <vector>

#include "protocol/wire/messages.h"

namespace protocol {

/// Walls that only one of the two has, or moves, a sentence each with what follows from it; nothing
/// where a side does not say what walls it has.
std::vector<std::string> one_sided_walls(const Hello& fluid, const Hello& solid);

/// A mesh among Hello::bodies, by the box around it: two that read the same are one wall.
std::string mesh_text(const Vec3& low, const Vec3& high);

/// What a body's name ends with where its program says whether it moves; one of the fluid that says
/// nothing is at rest, of one of the solid it is not known.
std::string motion_text(bool moves);

}  // namespace protocol
