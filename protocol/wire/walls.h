// SPDX-License-Identifier: MIT
#pragma once

#include <string>
#include <vector>

#include "protocol/wire/messages.h"

namespace protocol {

/// Walls that only one of the two has, a sentence each with what follows from it; nothing where a
/// side does not say what walls it has.
std::vector<std::string> one_sided_walls(const Hello& fluid, const Hello& solid);

}  // namespace protocol
