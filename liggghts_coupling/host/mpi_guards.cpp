// SPDX-License-Identifier: GPL-2.0-or-later
#include "liggghts_coupling/host/mpi_guards.h"

#include <unistd.h>

#include <cstdio>
#include <fstream>

#include "liggghts_coupling/host/coupling.h"
#include "protocol/program.h"

namespace dem {
namespace {

constexpr double kFarewellSeconds = 3.0;
MPI_Comm local = MPI_COMM_NULL;
std::string log_file;
bool meant = false;

MPI_Comm redirected(MPI_Comm comm) {
  return comm == MPI_COMM_WORLD && local != MPI_COMM_NULL ? local : comm;
}

std::string last_error_line() {
  std::ifstream log(log_file);
  std::string line, found;
  while (std::getline(log, line))
    if (line.rfind("ERROR", 0) == 0) found = line;
  return found.empty() ? "LIGGGHTS stopped with an error; see its output" : found;
}

/// Every rank comes here (error->all) or one alone (error->one, `lonely`).
[[noreturn]] void end_with_error(bool lonely) {
  std::fflush(stdout);
  protocol::Channel* channel = Coupling::instance().channel.get();
  if (channel && (lonely || channel->local_rank() == 0)) {
    channel->raise({protocol::kFault, last_error_line()});
    channel->await_farewell(kFarewellSeconds);
  } else if (channel) {
    sleep(static_cast<unsigned>(kFarewellSeconds) + 1);  // rank 0 ends the job
  }
  protocol::abort_job(protocol::kFault);
}

}  // namespace

void guard_mpi(MPI_Comm comm, const std::string& log) {
  local = comm;
  log_file = log;
}

void finalize_mpi() {
  meant = true;
  MPI_Finalize();
}

}  // namespace dem

extern "C" {

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
