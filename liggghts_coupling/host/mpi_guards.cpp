// SPDX-License-Identifier: GPL-2.0-or-later
#include "liggghts_coupling/host/mpi_guards.h"

#include "liggghts_coupling/host/coupling.h"
#include "protocol/program/mpi_calls.h"
#include "protocol/program/program.h"

namespace dem {
namespace {

std::function<std::string()> reason;

[[noreturn]] void end_with_error(bool lonely) {
  protocol::end_with_engine(reason(), Coupling::instance().channel.get(), lonely);
}

}  // namespace

void guard_mpi(MPI_Comm local, std::function<std::string()> why) {
  protocol::replace_world(local);
  reason = std::move(why);
}

}  // namespace dem

extern "C" {

// Every rank comes here after error->all, one alone to MPI_Abort after error->one. (The end that is
// meant is protocol::finish.)
int MPI_Finalize() {
  int over = 0;
  PMPI_Finalized(&over);
  if (!over) dem::end_with_error(false);
  return MPI_SUCCESS;
}
int MPI_Abort(MPI_Comm, int) {
  dem::end_with_error(true);
}

}  // extern "C"
