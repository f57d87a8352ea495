// SPDX-License-Identifier: MIT
/// Waits by asking: none ends too early, none too late, and one that shares its core notices.
#include "protocol/transport/polling.h"

#include <gtest/gtest.h>

namespace protocol {
namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point begin) {
  return std::chrono::duration<double>(Clock::now() - begin).count();
}

TEST(Polling, EndsWithTheAnswer) {
  for (const int turns : {1, 7, 500, 5000}) {  // in each of its phases
    int asked = 0;
    EXPECT_TRUE(poll(60.0, [&] { return ++asked == turns; }));
    EXPECT_EQ(asked, turns);
  }
}

TEST(Polling, EndsWithItsTimeAndAsksOnceMore) {
  const auto begin = Clock::now();
  EXPECT_FALSE(poll(0.02, [] { return false; }));
  EXPECT_GE(seconds_since(begin), 0.02);
  const auto again = Clock::now();
  EXPECT_TRUE(poll(0.02, [&] { return seconds_since(again) >= 0.02; }));
}

TEST(Polling, AThreadThatLacksTimeIsInACrowd) {
  const Crowd crowd;
  std::this_thread::sleep_for(std::chrono::milliseconds(5));
  EXPECT_TRUE(crowd.here());
}

TEST(Polling, AThreadThatComputesIsInNone) {
  bool alone = false;  // in one of many short times, whatever else this machine does
  for (int n = 0; n < 1000 && !alone; ++n) {
    const Crowd crowd;
    const auto begin = Clock::now();
    while (seconds_since(begin) < 1.5e-3) {
    }
    alone = !crowd.here();
  }
  EXPECT_TRUE(alone);
}

TEST(Polling, InACrowdItSleeps) {
  // A partner of whose every answer takes 2 ms of the clock, and none of the processor: the wait
  // for it finds the crowd, and the one after it sleeps at least 20 us between two of its turns. A
  // thread of its own, because a thread remembers the crowds of its earlier waits.
  std::thread([] {
    EXPECT_FALSE(poll(0.1, [] {
      std::this_thread::sleep_for(std::chrono::milliseconds(2));
      return false;
    }));
    int asked = 0;
    const auto begin = Clock::now();
    EXPECT_FALSE(poll(0.2, [&] { return ++asked, false; }));
    EXPECT_LT(asked, 50 + seconds_since(begin) / 20e-6);  // who never sleeps asks 10^6 times
  }).join();
}

}  // namespace
}  // namespace protocol
