// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

namespace protocol {

/// CRC-32 as zlib, gzip and PNG have it (polynomial 0xEDB88320): it finds every change of up to 32
/// bits in a row, and of other ones all but one in 4e9.
/// @param before  of the bytes before these ones
std::uint32_t crc32(std::span<const std::byte> bytes, std::uint32_t before = 0);

/// Length and checksum of a file's content.
struct Fingerprint {
  std::uint64_t bytes = 0;
  std::uint32_t crc = 0;
  bool operator==(const Fingerprint&) const = default;
};

/// Of the first so many bytes of a file, or of all of it. @throws std::runtime_error  cannot be
/// read
Fingerprint fingerprint(const std::string& path, std::uint64_t most = ~0ULL);

}  // namespace protocol
