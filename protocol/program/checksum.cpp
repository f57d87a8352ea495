// SPDX-License-Identifier: MIT
#include "protocol/program/checksum.h"

#include <algorithm>
#include <array>
#include <fstream>
#include <stdexcept>
#include <vector>

namespace protocol {
namespace {

constexpr std::size_t kSlices = 8;  // bytes a turn: one table for each place in them
using Tables = std::array<std::array<std::uint32_t, 256>, kSlices>;

constexpr Tables make_tables() {
  Tables t{};
  for (std::uint32_t n = 0; n < 256; ++n) {
    std::uint32_t c = n;
    for (int k = 0; k < 8; ++k) c = c & 1U ? 0xEDB88320U ^ (c >> 1U) : c >> 1U;
    t[0][n] = c;
  }
  for (std::size_t s = 1; s < kSlices; ++s)
    for (std::uint32_t n = 0; n < 256; ++n)
      t[s][n] = (t[s - 1][n] >> 8U) ^ t[0][t[s - 1][n] & 0xFFU];
  return t;
}

constexpr Tables kTables = make_tables();

}  // namespace

std::uint32_t crc32(std::span<const std::byte> bytes, std::uint32_t before) {
  std::uint32_t c = ~before;
  for (; bytes.size() >= kSlices; bytes = bytes.subspan(kSlices)) {
    std::uint32_t next = 0;
    for (std::size_t k = 0; k < kSlices; ++k) {
      const std::uint32_t old = k < 4 ? (c >> (8U * k)) & 0xFFU : 0U;
      next ^= kTables[kSlices - 1 - k][old ^ std::to_integer<std::uint32_t>(bytes[k])];
    }
    c = next;
  }
  for (const std::byte b : bytes)
    c = kTables[0][(c ^ std::to_integer<std::uint32_t>(b)) & 0xFFU] ^ (c >> 8U);
  return ~c;
}

Fingerprint fingerprint(const std::string& path, std::uint64_t most) {
  std::ifstream file(path, std::ios::binary);
  if (!file) throw std::runtime_error(path + " cannot be read");
  std::vector<char> buffer(1 << 20);
  Fingerprint found;
  while (file && found.bytes < most) {
    const auto want = std::min<std::uint64_t>(buffer.size(), most - found.bytes);
    file.read(buffer.data(), static_cast<std::streamsize>(want));
    const auto got = static_cast<std::size_t>(file.gcount());
    found.crc = crc32(std::as_bytes(std::span(buffer.data(), got)), found.crc);
    found.bytes += got;
  }
  return found;
}

}  // namespace protocol
