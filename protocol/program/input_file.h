// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <limits>
#include <string>

namespace protocol {

/// Why a file that a user names cannot be read as input: it is missing, no regular file, not
/// readable, or larger than `most` bytes. Empty where it can. A pipe would be waited for without
/// end, and a device such as /dev/zero has no end.
std::string why_unreadable(const std::string& path,
                           std::uintmax_t most = std::numeric_limits<std::uintmax_t>::max());

}  // namespace protocol
