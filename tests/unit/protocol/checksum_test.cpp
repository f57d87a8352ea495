// SPDX-License-Identifier: MIT
#include "protocol/program/checksum.h"

#include <gtest/gtest.h>

#include <string>

#include "tests/support/job.h"

namespace {

using protocol::crc32;

std::uint32_t crc(std::string_view text, std::uint32_t before = 0) {
  return crc32(std::as_bytes(std::span(text)), before);
}

// The check value of CRC-32/ISO-HDLC, and of a text that is longer than the slices.
TEST(Checksum, IsThatOfZlib) {
  EXPECT_EQ(crc("123456789"), 0xCBF43926U);
  EXPECT_EQ(crc(""), 0U);
  EXPECT_EQ(crc("The quick brown fox jumps over the lazy dog"), 0x414FA339U);
}

TEST(Checksum, OfPartsIsThatOfTheWhole) {
  const std::string text = "a line that is cut at every place in turn";
  for (std::size_t cut = 0; cut <= text.size(); ++cut)
    EXPECT_EQ(crc(text.substr(cut), crc(text.substr(0, cut))), crc(text)) << cut;
}

TEST(Checksum, OfAFile) {
  const test::TemporaryFolder folder;
  const std::string path = folder.write("f", "123456789 and more");
  EXPECT_EQ(protocol::fingerprint(path, 9), (protocol::Fingerprint{9, 0xCBF43926U}));
  EXPECT_EQ(protocol::fingerprint(path).bytes, 18U);
  EXPECT_THROW(protocol::fingerprint(folder.path() + "/none"), std::runtime_error);
}

}  // namespace
