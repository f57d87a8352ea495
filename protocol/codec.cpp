// SPDX-License-Identifier: MIT
#include "protocol/codec.h"

#include <fmt/format.h>

#include <cstring>
#include <limits>

#include "protocol/errors.h"

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
      throw BadMessage(fmt::format("expected a {} message, got {}", name(expected), name(kind)));
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
    std::uint8_t present = 0;
    *this >> present;
    if (present > 1) throw BadMessage("an optional field is neither present nor absent");
    value.reset();
    if (present) *this >> value.emplace();
    return *this;
  }
  Reader& operator>>(Variable& v) { return *this >> v.name >> v.value; }
  Reader& operator>>(StepHeader& h) { return *this >> h.interval >> h.time >> h.flags; }

  void expect_end() const {
    if (at_ != bytes_.size())
      throw BadMessage(fmt::format("{} bytes left over in a {} message", bytes_.size() - at_,
                                   name(kind_of(bytes_))));
  }

 private:
  std::size_t count(std::size_t item_size) {
    std::uint64_t n = 0;
    *this >> n;
    if (n > (bytes_.size() - at_) / item_size)
      throw BadMessage(fmt::format("a {} message promises {} items, more than it holds",
                                   name(kind_of(bytes_)), n));
    return n;
  }
  void copy(void* out, std::size_t size) {
    if (size > bytes_.size() - at_)
      throw BadMessage(fmt::format("a {} message ends too early", name(kind_of(bytes_))));
    if (size) std::memcpy(out, bytes_.data() + at_, size);
    at_ += size;
  }
  const Bytes& bytes_;
  std::size_t at_ = sizeof(FrameHead);
};

/// The fields of a hello, in order, once for both directions.
template <class Stream, class Message>
void hello_fields(Stream& s, Message& h) {
  auto io = [&s](auto&... field) {
    if constexpr (std::is_same_v<Stream, Writer>)
      (s << ... << field);
    else
      (s >> ... >> field);
  };
  io(h.version, h.role, h.program, h.program_version, h.dimension, h.box_lo, h.box_hi, h.periodic,
     h.depth, h.units, h.gravity, h.buoyancy, h.step, h.fluid_steps, h.solid_steps,
     h.first_interval, h.schedule, h.features, h.particles, h.radius, h.density, h.subdomain_lo,
     h.subdomain_hi, h.reach, h.variables);
}

}  // namespace

const char* name(Kind kind) {
  switch (kind) {
    case Kind::Hello:
      return "hello";
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
    throw BadMessage(fmt::format("a frame of {} bytes is too short", frame.size()));
  std::memcpy(&head, frame.data(), sizeof head);
  if (head.magic == kMagicSwapped)
    throw BadMessage("the partner runs on a machine of the other byte order: not supported");
  if (head.magic != kMagic) throw BadMessage("the partner does not speak the BPLBM protocol");
  if (head.kind < Kind::Hello || head.kind > Kind::Farewell)
    throw BadMessage(fmt::format("unknown kind of message {}", static_cast<unsigned>(head.kind)));
  if (head.payload != frame.size() - sizeof head)
    throw BadMessage(fmt::format("a {} message promises {} bytes and has {}", name(head.kind),
                                 head.payload, frame.size() - sizeof head));
  return head.kind;
}

Bytes encode(const Hello& hello) {
  Writer w(Kind::Hello);
  hello_fields(w, hello);
  return w.frame();
}
Bytes encode(const Answer& a) {
  return (Writer(Kind::Answer) << std::uint8_t{a.accept} << a.reasons).frame();
}
Bytes encode(const StateBatch& b) {
  return (Writer(Kind::States) << b.head << b.states << b.shapes).frame();
}
Bytes encode(const LoadBatch& b) {
  return (Writer(Kind::Loads) << b.head << b.loads).frame();
}
Bytes encode(const Goodbye& g) {
  return (Writer(Kind::Goodbye) << g.reason).frame();
}
Bytes encode(const Fault& f) {
  return (Writer(Kind::Fault) << f.exit_code << f.reason).frame();
}
Bytes encode(const Farewell&) {
  return Writer(Kind::Farewell).frame();
}

template <>
Hello decode(const Bytes& frame) {
  Reader r(frame, Kind::Hello);
  Hello hello;
  r >> hello.version;  // another version may have other fields: say so before reading them
  if (hello.version != kProtocolVersion)
    throw BadMessage(fmt::format("protocol version: partner speaks {}, this program {}; rebuild "
                                 "both programs from the same release",
                                 hello.version, kProtocolVersion),
                     kBadInput);
  Reader from_start(frame, Kind::Hello);
  hello_fields(from_start, hello);
  from_start.expect_end();
  return hello;
}

template <>
Answer decode(const Bytes& frame) {
  Answer a;
  std::uint8_t accept = 0;
  Reader r(frame, Kind::Answer);
  r >> accept >> a.reasons;
  r.expect_end();
  a.accept = accept != 0;
  return a;
}
template <>
StateBatch decode(const Bytes& frame) {
  StateBatch b;
  Reader r(frame, Kind::States);
  r >> b.head >> b.states >> b.shapes;
  r.expect_end();
  return b;
}
template <>
LoadBatch decode(const Bytes& frame) {
  LoadBatch b;
  Reader r(frame, Kind::Loads);
  r >> b.head >> b.loads;
  r.expect_end();
  return b;
}
template <>
Goodbye decode(const Bytes& frame) {
  Goodbye g;
  Reader r(frame, Kind::Goodbye);
  r >> g.reason;
  r.expect_end();
  return g;
}
template <>
Fault decode(const Bytes& frame) {
  Fault f;
  Reader r(frame, Kind::Fault);
  r >> f.exit_code >> f.reason;
  r.expect_end();
  return f;
}
template <>
Farewell decode(const Bytes& frame) {
  Reader(frame, Kind::Farewell).expect_end();
  return {};
}

}  // namespace protocol
