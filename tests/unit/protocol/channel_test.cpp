// SPDX-License-Identifier: MIT
/// The conversation over the in-process and the trace transport; tests/coupled carries it over MPI.
#include "protocol/channel.h"

#include <gtest/gtest.h>

#include <future>

#include "protocol/memory_channel.h"
#include "protocol/trace.h"
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
