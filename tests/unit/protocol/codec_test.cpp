// SPDX-License-Identifier: MIT
#include "protocol/wire/codec.h"

#include <gtest/gtest.h>

#include <array>

#include "protocol/wire/errors.h"
#include "tests/unit/protocol/samples.h"

namespace {

using namespace protocol;

std::vector<Bytes> one_of_each() {
  return {encode(test::sample_hello(Role::Fluid)),
          encode(Answer{false, {"a", "b c"}}),
          encode(test::sample_states(7, 3)),
          encode(test::sample_loads(7, 3)),
          encode(Goodbye{"done"}),
          encode(Fault{3, "NaN at (1, 2)"}),
          encode(Farewell{})};
}

/// Decodes a frame as what it says it is.
void decode_any(const Bytes& frame) {
  switch (kind_of(frame)) {
    case Kind::Hello:
      decode<Hello>(frame);
      return;
    case Kind::Answer:
      decode<Answer>(frame);
      return;
    case Kind::States:
      decode<StateBatch>(frame);
      return;
    case Kind::Loads:
      decode<LoadBatch>(frame);
      return;
    case Kind::Goodbye:
      decode<Goodbye>(frame);
      return;
    case Kind::Fault:
      decode<Fault>(frame);
      return;
    case Kind::Farewell:
      decode<Farewell>(frame);
      return;
  }
}

TEST(Codec, EveryMessageSurvivesARoundTrip) {
  for (const Role role : {Role::Fluid, Role::Solid}) {
    const Hello hello = test::sample_hello(role);
    const Hello back = decode<Hello>(encode(hello));
    EXPECT_EQ(encode(back), encode(hello));  // every field, to the bit
    EXPECT_EQ(back.particles, hello.particles);
    EXPECT_EQ(back.variables.at(1).value, "two words");
  }
  const auto states = decode<StateBatch>(encode(test::sample_states(42, 17)));
  EXPECT_TRUE(test::same_bits(states.states, test::sample_states(42, 17).states));
  EXPECT_TRUE(test::same_bits(states.shapes, test::sample_states(42, 17).shapes));
  EXPECT_EQ(states.head.interval, 42);
  const auto loads = decode<LoadBatch>(encode(test::sample_loads(42, 17)));
  EXPECT_TRUE(test::same_bits(loads.loads, test::sample_loads(42, 17).loads));
  EXPECT_EQ(decode<Answer>(encode(Answer{false, {"x", "y"}})).reasons.size(), 2U);
  EXPECT_EQ(decode<Fault>(encode(Fault{3, "why"})).exit_code, 3);
}

TEST(Codec, EmptyBatchesAreLegal) {
  EXPECT_TRUE(decode<StateBatch>(encode(StateBatch{})).states.empty());
  EXPECT_FALSE(decode<StateBatch>(encode(StateBatch{})).report.has_value());
  EXPECT_TRUE(decode<LoadBatch>(encode(LoadBatch{})).loads.empty());
}

TEST(Codec, RefusesEveryTruncation) {
  for (const Bytes& whole : one_of_each())
    for (std::size_t size = 0; size < whole.size(); ++size)
      EXPECT_THROW(decode_any(Bytes(whole.begin(), whole.begin() + static_cast<long>(size))),
                   BadMessage)
          << name(kind_of(whole)) << " cut to " << size;
}

TEST(Codec, DamagedFramesThrowBadMessageOrDecodeButNeverMore) {
  std::mt19937 random(1);
  for (const Bytes& whole : one_of_each())
    for (int trial = 0; trial < 2000; ++trial) {
      Bytes damaged = whole;
      for (int hits = 0; hits < 3; ++hits)
        damaged[random() % damaged.size()] = static_cast<std::byte>(random());
      try {
        decode_any(damaged);
      } catch (const BadMessage&) {
      }
    }
}

TEST(Codec, TellsTheOtherByteOrderAndStrangers) {
  Bytes frame = encode(Goodbye{"x"});
  std::swap(frame[0], frame[3]);
  std::swap(frame[1], frame[2]);
  try {
    kind_of(frame);
    FAIL() << "accepted";
  } catch (const BadMessage& e) {
    EXPECT_NE(std::string(e.what()).find("byte order"), std::string::npos) << e.what();
  }
  EXPECT_THROW(kind_of(Bytes(100, std::byte{7})), BadMessage);
}

TEST(Codec, NamesBothProtocolVersions) {
  Hello hello = test::sample_hello(Role::Solid);
  hello.version = kProtocolVersion + 1;
  try {
    decode<Hello>(encode(hello));
    FAIL() << "accepted";
  } catch (const BadMessage& e) {
    EXPECT_NE(std::string(e.what()).find("protocol version"), std::string::npos) << e.what();
    EXPECT_EQ(e.exit_code(), kBadInput);
  }
}

TEST(Codec, WhatASolidReportsGoesWithTheStates) {
  StateBatch batch = test::sample_states(3, 2);
  batch.report = SolidReport{6, BondCounts{17, 4, 3, 2, 1}, {{1, 2, 0}, {2, 9, 1}}};
  auto back = decode<StateBatch>(encode(batch));
  ASSERT_TRUE(back.report && back.report->bonds);
  EXPECT_EQ(back.report->grains_left, 6);
  const BondCounts& b = *back.report->bonds;
  EXPECT_EQ((std::array{b.intact, b.tension, b.shear, b.left, b.lost}),
            (std::array<std::int64_t, 5>{17, 4, 3, 2, 1}));
  EXPECT_TRUE(test::same_bits(back.report->list, batch.report->list));
  batch.report = SolidReport{2, std::nullopt, {}};
  back = decode<StateBatch>(encode(batch));
  ASSERT_TRUE(back.report);
  EXPECT_EQ(back.report->grains_left, 2);
  EXPECT_FALSE(back.report->bonds);
}

}  // namespace
