// SPDX-License-Identifier: MIT
#pragma once

#include <string>
#include <vector>

#include "protocol/wire/messages.h"

namespace protocol {

/// Compares what the two sides believe about the same scene.
/// @return every disagreement, one sentence each with both values; empty means accepted
std::vector<std::string> disagreements(const Hello& fluid, const Hello& solid);

}  // namespace protocol
