// SPDX-License-Identifier: MIT
/// `channel_peer fluid|solid` carries the conversation over a real MPI job.
#include <fmt/format.h>

#include <cstring>

#include "protocol/transport/mpi_channel.h"
#include "tests/unit/protocol/conversation.h"

int main(int argc, char** argv) {
  MPI_Init(&argc, &argv);
  const auto role = argc > 1 && std::strcmp(argv[1], "fluid") == 0 ? protocol::Role::Fluid
                                                                   : protocol::Role::Solid;
  try {
    protocol::World world = protocol::connect(role);
    auto channel = protocol::make_mpi_channel(world, role);
    test::timeout_part(*channel);
    MPI_Barrier(MPI_COMM_WORLD);  // nobody speaks before everybody's time-out is over
    (role == protocol::Role::Fluid ? test::fluid_part : test::solid_part)(*channel);
    MPI_Barrier(MPI_COMM_WORLD);
    fmt::print("conversation complete, {} rank {}\n", argv[1], channel->local_rank());
    channel.reset();
    protocol::disconnect(world);
  } catch (const std::exception& e) {
    fmt::print(stderr, "FAILED {}: {}\n", argv[1], e.what());
    MPI_Abort(MPI_COMM_WORLD, 9);
  }
  MPI_Finalize();
  return 0;
}
