// SPDX-License-Identifier: MIT
/// Any bytes as a frame: either a BadMessage, or a message that is written back to the same bytes.
#include <cstring>

#include "protocol/wire/codec.h"
#include "protocol/wire/errors.h"

namespace {

using namespace protocol;

template <class Message>
void round_trip(const Bytes& frame) {
  if (encode(decode<Message>(frame)) != frame) __builtin_trap();
}

void read(const Bytes& frame) {
  switch (kind_of(frame)) {
    case Kind::Hello:
      return round_trip<Hello>(frame);
    case Kind::Answer:
      return round_trip<Answer>(frame);
    case Kind::States:
      return round_trip<StateBatch>(frame);
    case Kind::Loads:
      return round_trip<LoadBatch>(frame);
    case Kind::Goodbye:
      return round_trip<Goodbye>(frame);
    case Kind::Fault:
      return round_trip<Fault>(frame);
    case Kind::Farewell:
      return round_trip<Farewell>(frame);
  }
}

}  // namespace

/// The first byte chooses the kind; the head is made right, so that the fuzzer gets past it.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  const std::uint32_t magic = 0x4C425042, kind = data[0] % 9;
  const std::uint64_t payload = size - 1;
  Bytes frame(16 + payload);
  std::memcpy(frame.data(), &magic, 4);
  std::memcpy(frame.data() + 4, &kind, 4);
  std::memcpy(frame.data() + 8, &payload, 8);
  if (payload) std::memcpy(frame.data() + 16, data + 1, payload);
  try {
    read(frame);
  } catch (const BadMessage&) {
  }
  return 0;
}
