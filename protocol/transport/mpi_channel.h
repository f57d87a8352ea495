// SPDX-License-Identifier: MIT
#pragma once

#include <mpi.h>

#include <memory>

#include "protocol/wire/channel.h"

namespace protocol {

/// The communicators of one coupled MPI job.
struct World {
  MPI_Comm local = MPI_COMM_NULL;   ///< the ranks of this program
  MPI_Comm remote = MPI_COMM_NULL;  ///< intercommunicator to the partner; null when alone
  int partner_ranks = 0;
  bool coupled() const { return partner_ranks > 0; }
};

/// Finds out which ranks of MPI_COMM_WORLD are fluid and which solid, in any order and number, and
/// builds the communicators. Uses only polled point-to-point messages until everybody has answered,
/// so that a program that does not know this protocol cannot hang it.
/// @param seconds  how long the others may take to start; negative: 30 s for a fluid, 60 s for a
///                 solid. BPLBM_CONNECT_TIMEOUT in the environment counts instead. A solid waits as
///                 long as the fluid does that it hears of
/// @throws Timeout naming the ranks that did not answer, and the cure
World connect(Role role, double seconds = -1.0);

/// Frees the communicators, where the process goes on to another connection. A program that ends
/// leaves them to MPI: see `finish` in program.h.
void disconnect(World& world);

/// A channel over the intercommunicator of `world`.
std::unique_ptr<Channel> make_mpi_channel(const World& world, Role role);

}  // namespace protocol
