// SPDX-License-Identifier: MIT
/// What a program needs to record its exchange, with or without HDF5.
#pragma once

#include <memory>
#include <string>

#include "protocol/wire/channel.h"

namespace protocol {

/// From now on the channel writes what passes through it to a trace (trace.h). Where that cannot be
/// made, the channel stays as it is.
/// @param recorder  "fluid" or "solid"
/// @param received  a frame that came from each rank of the other side before; none where empty
/// @throws std::runtime_error  the file cannot be made
/// @throws ProgramError  the library was built without HDF5
void record_to(const std::string& file, std::unique_ptr<Channel>& channel,
               const std::string& recorder, int local_rank, const Bytes& received = {});

}  // namespace protocol
