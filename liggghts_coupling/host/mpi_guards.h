// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <mpi.h>

#include <functional>
#include <string>

namespace dem {

/// LIGGGHTS believes that MPI_COMM_WORLD is its own and that it may end the process when it likes.
/// Functions that stand in front of the library's (MPI's profiling interface) see to it that
/// - every call on MPI_COMM_WORLD, of LIGGGHTS or VTK, uses `local` instead
/// (protocol/program/mpi_calls.h);
/// - an MPI_Finalize or MPI_Abort is LIGGGHTS ending with an error: the fluid is told why, and the
///   job is aborted.
/// @param reason  of such an end, in words
void guard_mpi(MPI_Comm local, std::function<std::string()> reason);

}  // namespace dem
