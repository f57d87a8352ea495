// SPDX-License-Identifier: MIT
/// The conversation over the in-process and the trace transport; tests/coupled carries it over MPI.
#include "protocol/wire/channel.h"

#include <gtest/gtest.h>

#include <future>

#include "protocol/transport/memory_channel.h"
#include "protocol/transport/trace.h"
#include "tests/support/job.h"
#include "tests/unit/protocol/conversation.h"

namespace {

using namespace protocol;

using Parts = std::vector<std::future<void>>;

void finish(Parts& parts) {
  for (auto& p : parts) EXPECT_NO_THROW(p.get());
}

/// Runs one thread a rank.
void converse(MemoryLink& link) {
  Parts parts;
  for (auto& c : link.fluid)
    parts.push_back(std::async(std::launch::async, [&c] { test::fluid_part(*c); }));
  for (auto& c : link.solid)
    parts.push_back(std::async(std::launch::async, [&c] { test::solid_part(*c); }));
  finish(parts);
}

TEST(MemoryChannel, CarriesTheConversation) {
  for (const auto& [fluid, solid] : {std::pair{1, 1}, {1, 3}, {2, 1}}) {
    MemoryLink link = make_memory_link(fluid, solid);
    converse(link);
  }
}

TEST(MemoryChannel, TimesOutWithAName) {
  MemoryLink link = make_memory_link(1, 1);
  EXPECT_NO_THROW(test::timeout_part(*link.fluid[0]));
  EXPECT_NO_THROW(test::timeout_part(*link.solid[0]));
}

TEST(MemoryChannel, AfterAFarewellNothingMoreComes) {
  MemoryLink link = make_memory_link(1, 2);
  Channel &fluid = *link.fluid[0], &first = *link.solid[0], &second = *link.solid[1];
  first.send(0, encode(Goodbye{"the end"}), test::kPatience);
  first.say_farewell();
  EXPECT_EQ(decode<Goodbye>(fluid.receive(0, test::kPatience)).reason, "the end");
  EXPECT_THROW(fluid.receive(0, test::kPatience), PeerLeft);
  EXPECT_EQ(fluid.await_farewell(0.05).missing, std::vector<int>{1});
  second.say_farewell();
  EXPECT_TRUE(fluid.await_farewell(1.0).missing.empty());
  second.raise({3, "after all"});
  ASSERT_TRUE(fluid.await_farewell(1.0).fault);
  EXPECT_EQ(fluid.await_farewell(1.0).fault->exit_code, 3);
}

TEST(MemoryChannel, OneThatWaitsLearnsOfAFarewell) {
  MemoryLink link = make_memory_link(1, 1);
  auto waits =
      std::async(std::launch::async, [&] { return link.fluid[0]->receive(0, test::kPatience); });
  link.solid[0]->say_farewell();
  EXPECT_THROW(waits.get(), PeerLeft);
}

TEST(TraceChannel, ReplaysTheConversationToEachSideAlone) {
  const test::TemporaryFolder folder;
  const std::string fluid_file = folder.path() + "/fluid.h5",
                    solid_file = folder.path() + "/solid.h5";
  {
    MemoryLink link = make_memory_link(1, 1);
    link.fluid[0] = make_recording_channel(
        std::move(link.fluid[0]), std::make_unique<TraceWriter>(fluid_file, "fluid", 0, 1));
    link.solid[0] = make_recording_channel(
        std::move(link.solid[0]), std::make_unique<TraceWriter>(solid_file, "solid", 0, 1));
    converse(link);
  }
  const auto fluid = make_replay_channel(std::make_shared<Trace>(fluid_file));
  EXPECT_NO_THROW(test::fluid_part(*fluid));
  const auto solid = make_replay_channel(std::make_shared<Trace>(solid_file));
  EXPECT_NO_THROW(test::solid_part(*solid));
}

TEST(TraceChannel, SaysWhereTheRecordingEnds) {
  const test::TemporaryFolder folder;
  const std::string file = folder.path() + "/empty.h5";
  { const TraceWriter nothing(file, "fluid", 0, 1); }
  const auto channel = make_replay_channel(std::make_shared<Trace>(file));
  EXPECT_THROW(channel->receive(0, test::kPatience), Timeout);
}

}  // namespace
