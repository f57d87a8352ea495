// SPDX-License-Identifier: MIT
#pragma once

#include <memory>
#include <vector>

#include "protocol/wire/channel.h"

namespace protocol {

/// Both ends of an in-process link with any number of ranks a side, for tests and embedding: one
/// channel a rank, each to be used by one thread.
struct MemoryLink {
  std::vector<std::unique_ptr<Channel>> fluid, solid;
};

MemoryLink make_memory_link(int fluid_ranks, int solid_ranks);

}  // namespace protocol
