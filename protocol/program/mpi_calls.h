// SPDX-License-Identifier: MIT
/// Every MPI function that takes a communicator, or waits, stands once more in front of the
/// library's (MPI's profiling interface; `wrap_mpi.py` writes them from mpi.h): the watch sees what
/// the main thread waits in, and MPI_COMM_WORLD can be made to mean one program only.
#pragma once

#include <mpi.h>

namespace protocol {

/// From now on MPI_COMM_WORLD is `own` to everybody in this process. A library that knows of one
/// program only (an engine, its VTK) talks on the world, where the partner would never answer.
void replace_world(MPI_Comm own);

}  // namespace protocol
