// SPDX-License-Identifier: MIT
#include "protocol/transport/recording.h"
#include "protocol/wire/errors.h"

namespace protocol {

void record_to(const std::string& file, std::unique_ptr<Channel>&, const std::string&, int,
               const Bytes&) {
  throw ProgramError(file +
                         ": a recording needs HDF5, without which this program was built; leave "
                         "it out, or build with HDF5",
                     kBadInput);
}

}  // namespace protocol
