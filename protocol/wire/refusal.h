// SPDX-License-Identifier: MIT
#pragma once

#include "protocol/wire/errors.h"
#include "protocol/wire/text.h"

namespace protocol {

/// What arrived is not what was agreed.
template <class... Args>
[[noreturn]] void refuse(Pattern<sizeof...(Args)> pattern, const Args&... args) {
  throw BadMessage(format(pattern, args...), kBadInput);
}

}  // namespace protocol
