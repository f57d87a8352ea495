// SPDX-License-Identifier: MIT
#include "protocol/wire/codec.h"

#include <cstring>
#include <limits>

#include "protocol/wire/errors.h"
#include "protocol/wire/text.h"

namespace protocol {
namespace {

constexpr std::uint32_t kMagic = 0x4C425042;         // "BPBL" in memory on a little-endian machine
constexpr std::uint32_t kMagicSwapped = 0x4250424C;  // the same from a big-endian one

struct FrameHead {
  std::uint32_t magic = kMagic;
  Kind kind{};
  std::uint64_t payload = 0;
};
static_assert(sizeof(FrameHead) == 16);

/// Appends plain values, texts and arrays behind the head; `frame()` completes the head.
class Writer {
 public:
  explicit Writer(Kind kind) : bytes_(sizeof(FrameHead)) { head_.kind = kind; }

  template <class T>
  Writer& operator<<(const T& value) {
    static_assert(std::is_trivially_copyable_v<T>);
    append(&value, sizeof value);
    return *this;
  }
  Writer& operator<<(const std::string& text) {
    *this << std::uint64_t{text.size()};
    append(text.data(), text.size());
    return *this;
  }
  template <class T>
  Writer& operator<<(const std::vector<T>& items) {
    *this << std::uint64_t{items.size()};
    if constexpr (std::is_trivially_copyable_v<T>)
      append(items.data(), items.size() * sizeof(T));
    else
      for (const auto& item : items) *this << item;
    return *this;
  }
  template <class T>
  Writer& operator<<(const std::optional<T>& value) {
    *this << std::uint8_t{value.has_value()};
    return value ? *this << *value : *this;
  }
  Writer& operator<<(const BondCounts& b) {
    return *this << b.intact << b.tension << b.shear << b.left << b.lost;
  }
  Writer& operator<<(const SolidReport& r) { return *this << r.grains_left << r.bonds << r.list; }
  Writer& operator<<(const Variable& v) { return *this << v.name << v.value; }
  Writer& operator<<(const StepHeader& h) { return *this << h.interval << h.time << h.flags; }

  Bytes frame() {
    head_.payload = bytes_.size() - sizeof head_;
    std::memcpy(bytes_.data(), &head_, sizeof head_);
    return std::move(bytes_);
  }

 private:
  void append(const void* data, std::size_t size) {
    const auto* first = static_cast<const std::byte*>(data);
    bytes_.insert(bytes_.end(), first, first + size);
  }
  FrameHead head_;
  Bytes bytes_;
};

/// Reads what Writer wrote; every read is checked against the end of the frame.
class Reader {
 public:
  Reader(const Bytes& frame, Kind expected) : bytes_(frame) {
    const Kind kind = kind_of(frame);
    if (kind != expected)
      throw BadMessage(format("expected a {} message, got {}", name(expected), name(kind)));
  }

  Reader& operator>>(bool& value) {  // a byte other than 0 and 1 is no bool
    std::uint8_t byte = 0;
    *this >> byte;
    if (byte > 1) throw BadMessage("a flag is neither 0 nor 1");
    value = byte == 1;
    return *this;
  }
  template <class T>
  Reader& operator>>(T& value) {
    static_assert(std::is_trivially_copyable_v<T>);
    copy(&value, sizeof value);
    return *this;
  }
  Reader& operator>>(std::string& text) {
    text.resize(count(1));
    copy(text.data(), text.size());
    return *this;
  }
  template <class T>
  Reader& operator>>(std::vector<T>& items) {
    if constexpr (std::is_trivially_copyable_v<T>) {
      items.resize(count(sizeof(T)));
      copy(items.data(), items.size() * sizeof(T));
    } else {
      items.resize(count(1));
      for (auto& item : items) *this >> item;
    }
    return *this;
  }
  template <class T>
  Reader& operator>>(std::optional<T>& value) {
    bool present = false;
    *this >> present;
    value.reset();
    if (present) *this >> value.emplace();
    return *this;
  }
  Reader& operator>>(BondCounts& b) {
    return *this >> b.intact >> b.tension >> b.shear >> b.left >> b.lost;
  }
  Reader& operator>>(SolidReport& r) { return *this >> r.grains_left >> r.bonds >> r.list; }
  Reader& operator>>(Variable& v) { return *this >> v.name >> v.value; }
  Reader& operator>>(StepHeader& h) { return *this >> h.interval >> h.time >> h.flags; }

  void expect_end() const {
    if (at_ != bytes_.size())
      throw BadMessage(
          format("{} bytes left over in a {} message", bytes_.size() - at_, name(kind_of(bytes_))));
  }

 private:
  std::size_t count(std::size_t item_size) {
    std::uint64_t n = 0;
    *this >> n;
    if (n > (bytes_.size() - at_) / item_size)
      throw BadMessage(
          format("a {} message promises {} items, more than it holds", name(kind_of(bytes_)), n));
    return n;
  }
  void copy(void* out, std::size_t size) {
    if (size > bytes_.size() - at_)
      throw BadMessage(format("a {} message ends too early", name(kind_of(bytes_))));
    if (size) std::memcpy(out, bytes_.data() + at_, size);
    at_ += size;
  }
  const Bytes& bytes_;
  std::size_t at_ = sizeof(FrameHead);
};

/// The fields of a message in their order, once for both directions: `io(fields…)` writes or reads.
template <class Io, class M>
void fields(Io&& io, M& m) requires std::is_same_v<std::remove_const_t<M>, Hello> {
  io(m.version, m.role, m.program, m.program_version, m.dimension, m.box_lo, m.box_hi, m.periodic,
     m.depth, m.units, m.gravity, m.buoyancy, m.step, m.fluid_steps, m.solid_steps,
     m.first_interval, m.schedule, m.features, m.particles, m.radius, m.density, m.subdomain_lo,
     m.subdomain_hi, m.reach, m.sides, m.bodies, m.variables);
}
template <class Io, class M>
void fields(Io&& io, M& m) requires std::is_same_v<std::remove_const_t<M>, Answer> {
  io(m.accept, m.reasons);
}
template <class Io, class M>
void fields(Io&& io, M& m) requires std::is_same_v<std::remove_const_t<M>, StateBatch> {
  io(m.head, m.setting, m.states, m.shapes, m.report);
}
template <class Io, class M>
void fields(Io&& io, M& m) requires std::is_same_v<std::remove_const_t<M>, LoadBatch> {
  io(m.head, m.loads);
}
template <class Io, class M>
void fields(Io&& io, M& m) requires std::is_same_v<std::remove_const_t<M>, Goodbye> {
  io(m.reason);
}
template <class Io, class M>
void fields(Io&& io, M& m) requires std::is_same_v<std::remove_const_t<M>, Fault> {
  io(m.exit_code, m.reason);
}
template <class Io, class M>
void fields(Io&& io, M&) requires std::is_same_v<std::remove_const_t<M>, Farewell> {
  io();
}

template <class Message>
Bytes write(Kind kind, const Message& message) {
  Writer writer(kind);
  fields([&writer](const auto&... field) { static_cast<void>((writer << ... << field)); }, message);
  return writer.frame();
}

template <class Message>
Message read(Kind kind, const Bytes& frame) {
  Reader reader(frame, kind);
  Message message;
  fields([&reader](auto&... field) { static_cast<void>((reader >> ... >> field)); }, message);
  reader.expect_end();
  return message;
}

}  // namespace

const char* name(Kind kind) {
  switch (kind) {
    case Kind::Hello:
      return "handshake";
    case Kind::Answer:
      return "answer";
    case Kind::States:
      return "states";
    case Kind::Loads:
      return "loads";
    case Kind::Goodbye:
      return "goodbye";
    case Kind::Fault:
      return "fault";
    case Kind::Farewell:
      return "farewell";
  }
  return "unknown";
}

Kind kind_of(const Bytes& frame) {
  FrameHead head;
  if (frame.size() < sizeof head)
    throw BadMessage(format("a frame of {} bytes is too short", frame.size()));
  std::memcpy(&head, frame.data(), sizeof head);
  if (head.magic == kMagicSwapped)
    throw BadMessage("the partner runs on a machine of the other byte order: not supported");
  if (head.magic != kMagic) throw BadMessage("the partner does not speak the BPLBM protocol");
  if (head.kind < Kind::Hello || head.kind > Kind::Farewell)
    throw BadMessage(format("unknown kind of message {}", static_cast<unsigned>(head.kind)));
  if (head.payload != frame.size() - sizeof head)
    throw BadMessage(format("a {} message promises {} bytes and has {}", name(head.kind),
                            head.payload, frame.size() - sizeof head));
  return head.kind;
}

Bytes encode(const Hello& m) {
  return write(Kind::Hello, m);
}
Bytes encode(const Answer& m) {
  return write(Kind::Answer, m);
}
Bytes encode(const StateBatch& m) {
  return write(Kind::States, m);
}
Bytes encode(const LoadBatch& m) {
  return write(Kind::Loads, m);
}
Bytes encode(const Goodbye& m) {
  return write(Kind::Goodbye, m);
}
Bytes encode(const Fault& m) {
  return write(Kind::Fault, m);
}
Bytes encode(const Farewell& m) {
  return write(Kind::Farewell, m);
}

template <>
Hello decode(const Bytes& frame) {
  std::uint32_t version = 0;  // another version may have other fields: look before reading them
  Reader(frame, Kind::Hello) >> version;
  if (version != kProtocolVersion)
    throw BadMessage(format("protocol version: partner speaks {}, this program {}; rebuild "
                            "both programs from the same release",
                            version, kProtocolVersion),
                     kBadInput);
  return read<Hello>(Kind::Hello, frame);
}
template <>
Answer decode(const Bytes& frame) {
  return read<Answer>(Kind::Answer, frame);
}
template <>
StateBatch decode(const Bytes& frame) {
  return read<StateBatch>(Kind::States, frame);
}
template <>
LoadBatch decode(const Bytes& frame) {
  return read<LoadBatch>(Kind::Loads, frame);
}
template <>
Goodbye decode(const Bytes& frame) {
  return read<Goodbye>(Kind::Goodbye, frame);
}
template <>
Fault decode(const Bytes& frame) {
  return read<Fault>(Kind::Fault, frame);
}
template <>
Farewell decode(const Bytes& frame) {
  return read<Farewell>(Kind::Farewell, frame);
}

}  // namespace protocol
