// SPDX-License-Identifier: MIT
/// One conversation that every transport must carry, seen from both sides. Each part throws
/// std::runtime_error at the first thing that is not as the contract of Channel says.
#pragma once

#include <stdexcept>

#include "protocol/wire/channel.h"
#include "tests/unit/protocol/samples.h"

namespace test {

inline const protocol::Wait kPatience{20.0, "the next frame of the test"};
inline constexpr int kLarge = 20000;  // records: far beyond MPI's eager limit

inline void require(bool condition, const std::string& what) {
  if (!condition) throw std::runtime_error("conversation: " + what);
}

inline void fluid_part(protocol::Channel& c) {
  using namespace protocol;
  for (int r = 0; r < c.remote_size(); ++r) c.send(r, encode(sample_hello(Role::Fluid)), kPatience);
  for (int r = 0; r < c.remote_size(); ++r) {
    require(decode<Hello>(c.receive(r, kPatience)).program == "liggghts", "hello");
    for (std::int64_t k = 0; k < 3; ++k) {  // three frames at once: order kept, none lost
      const int count = k == 0 ? 0 : k == 1 ? 5 : kLarge;
      const auto batch = decode<StateBatch>(c.receive(r, kPatience));
      require(batch.head.interval == k, "order of states");
      require(same_bits(batch.states, sample_states(k, count, 1 + 100 * r).states),
              "bits of states");
    }
    c.send(r, encode(sample_loads(2, kLarge)), kPatience);
    c.send(r, encode(sample_loads(3, 0)), kPatience);
  }
  // rank 0 comes last: it alone fails, and a fault would stop the rest of this loop
  for (int r = c.remote_size() - 1; r >= 0; --r) c.send(r, encode(Goodbye{"fail now"}), kPatience);
  try {  // the fault overtakes whatever else would come
    c.receive(0, kPatience);
    require(false, "no fault came");
  } catch (const PeerFault& fault) {
    require(fault.exit_code() == 3 && std::string(fault.what()) == "on purpose",
            "text of the fault");
  }
  c.say_farewell();
}

inline void solid_part(protocol::Channel& c) {
  using namespace protocol;
  for (int r = 0; r < c.remote_size(); ++r) {
    require(decode<Hello>(c.receive(r, kPatience)).program == "lbm", "hello");
    c.send(r, encode(sample_hello(Role::Solid)), kPatience);
  }
  for (int r = 0; r < c.remote_size(); ++r)
    for (std::int64_t k = 0; k < 3; ++k)
      c.send(r,
             encode(sample_states(k,
                                  k == 0   ? 0
                                  : k == 1 ? 5
                                           : kLarge,
                                  1 + 100 * c.local_rank())),
             kPatience);
  for (int r = 0; r < c.remote_size(); ++r) {
    const auto loads = decode<LoadBatch>(c.receive(r, kPatience));
    require(same_bits(loads.loads, sample_loads(2, kLarge).loads), "bits of loads");
    require(decode<LoadBatch>(c.receive(r, kPatience)).loads.empty(), "empty loads");
  }
  for (int r = 0; r < c.remote_size(); ++r)
    require(decode<Goodbye>(c.receive(r, kPatience)).reason == "fail now", "goodbye");
  if (c.local_rank() != 0) return;
  c.raise({3, "on purpose"});
  c.await_farewell(10.0);
}

/// A wait for something that never comes ends in time and names whom and what.
inline void timeout_part(protocol::Channel& c) {
  try {
    c.receive(0, {0.05, "the impossible"});
    require(false, "no time-out");
  } catch (const protocol::Timeout& e) {
    const std::string text = e.what();
    require(text.find(c.remote_name() + " rank 0") != std::string::npos &&
                text.find("the impossible") != std::string::npos,
            "text of the time-out: " + text);
  }
}

}  // namespace test
