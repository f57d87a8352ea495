// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <mpi.h>

#include <functional>
#include <string>

namespace dem {

/// LIGGGHTS believes that MPI_COMM_WORLD is its own and that it may end the process when it likes.
/// `mpi_guards.cpp` defines some MPI functions in front of the library's (MPI's profiling
/// interface):
/// - calls on MPI_COMM_WORLD from VTK dumps and timing output use `local` instead;
/// - an MPI_Finalize or MPI_Abort that we did not ask for is LIGGGHTS ending with an error: the
///   fluid is told why, and the job is aborted.
/// @param reason  of such an end, in words
void guard_mpi(MPI_Comm local, std::function<std::string()> reason);

/// The one MPI_Finalize that is meant.
void finalize_mpi();

}  // namespace dem
