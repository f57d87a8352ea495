// SPDX-License-Identifier: MIT
/// Messages to bytes and back. A frame is a 16-byte head {magic, kind, payload size} and a payload.
/// Numbers travel in the sender's byte order; the magic number tells a receiver of another order.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "protocol/wire/messages.h"

namespace protocol {

using Bytes = std::vector<std::byte>;

enum class Kind : std::uint32_t {
  Hello = 1,
  Answer = 2,
  States = 3,
  Loads = 4,
  Goodbye = 5,
  Fault = 6,
  Farewell = 7,
};

const char* name(Kind kind);

/// Kind of a frame.
/// @throws BadMessage wrong magic, unknown kind, or a length other than the head promises
Kind kind_of(const Bytes& frame);

/// Each message has one of these; decode<T> throws BadMessage where the bytes do not fit T.
Bytes encode(const Hello&);
Bytes encode(const Answer&);
Bytes encode(const StateBatch&);
Bytes encode(const LoadBatch&);
Bytes encode(const Goodbye&);
Bytes encode(const Fault&);
Bytes encode(const Farewell&);

template <class T>
T decode(const Bytes& frame);

}  // namespace protocol
