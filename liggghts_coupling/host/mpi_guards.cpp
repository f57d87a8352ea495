// SPDX-License-Identifier: GPL-2.0-or-later
#include "liggghts_coupling/host/mpi_guards.h"

#include "liggghts_coupling/host/coupling.h"
#include "protocol/program.h"

namespace dem {
namespace {

MPI_Comm local = MPI_COMM_NULL;
std::function<std::string()> reason;
bool meant = false;

MPI_Comm redirected(MPI_Comm comm) {
  return comm == MPI_COMM_WORLD && local != MPI_COMM_NULL ? local : comm;
}

[[noreturn]] void end_with_error(bool lonely) {
  protocol::end_with_engine(reason(), Coupling::instance().channel.get(), lonely);
}

}  // namespace

void guard_mpi(MPI_Comm comm, std::function<std::string()> why) {
  local = comm;
  reason = std::move(why);
}

void finalize_mpi() {
  meant = true;
  MPI_Finalize();
}

}  // namespace dem

extern "C" {

// Every rank comes here after error->all, one alone to MPI_Abort after error->one.
int MPI_Finalize() {
  if (!dem::meant) dem::end_with_error(false);
  return PMPI_Finalize();
}
int MPI_Abort(MPI_Comm, int) {
  dem::end_with_error(true);
}

int MPI_Comm_dup(MPI_Comm comm, MPI_Comm* copy) {
  return PMPI_Comm_dup(dem::redirected(comm), copy);
}
int MPI_Comm_rank(MPI_Comm comm, int* rank) {
  return PMPI_Comm_rank(dem::redirected(comm), rank);
}
int MPI_Comm_size(MPI_Comm comm, int* size) {
  return PMPI_Comm_size(dem::redirected(comm), size);
}
int MPI_Barrier(MPI_Comm comm) {
  return PMPI_Barrier(dem::redirected(comm));
}
int MPI_Gather(const void* send, int send_count, MPI_Datatype send_type, void* receive,
               int receive_count, MPI_Datatype receive_type, int root, MPI_Comm comm) {
  return PMPI_Gather(send, send_count, send_type, receive, receive_count, receive_type, root,
                     dem::redirected(comm));
}

}  // extern "C"
