// SPDX-License-Identifier: GPL-2.0-or-later
/// What a script may do between two runs, and what not; the recording of all of them.
#include <atom.h>
#include <comm.h>
#include <domain.h>
#include <error.h>
#include <fmt/core.h>
#include <signal_handling.h>
#include <update.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "liggghts_coupling/host/coupling.h"
#include "liggghts_coupling/host/fix_lbm_couple.h"
#include "protocol/transport/recording.h"
#include "protocol/wire/agreement.h"

namespace dem {

namespace SignalHandler = LAMMPS_NS::SignalHandler;

/// A later run goes on where the one before ended, with the loads held there. What the script did
/// to the particles in between, the fluid sees with the next states.
void FixLbmCouple::go_on() const {
  if (update->ntimestep != step_)
    fail(
        fmt::format("the step was {} at the end of the last run and is {} now: the fluid counts "
                    "on; leave out reset_timestep",
                    step_, update->ntimestep));
  if (update->dt != time_step_)
    fail(
        fmt::format("the time step was {:g} s in the last run and is {:g} s now: the fluid was "
                    "told the first one",
                    time_step_, update->dt));
  const auto reasons = disagreements(Coupling::instance().session->fluid(), hello());
  if (!reasons.empty())
    throw protocol::ProtocolError(fmt::format("at step {}, since the last run, {}",
                                              update->ntimestep, protocol::Refusal(reasons).what()),
                                  protocol::kBadInput);
  begin_anew_where_moved();
}

/// A particle that the script has put elsewhere or made another size is another one for the fluid.
void FixLbmCouple::begin_anew_where_moved() const {
  if (marked_ != update->ntimestep) return;
  for (int i = 0; i < atom->nlocal; ++i) {
    bool same = atom->radius[i] == held_[i][kRadius];
    for (int k = 0; k < 3; ++k) {
      double way = atom->x[i][k] - held_[i][kPlace + k];
      if (domain->periodicity[k]) way -= domain->prd[k] * std::round(way / domain->prd[k]);
      same = same && std::abs(way) <= 1e-9 * domain->prd[k];
    }
    if (!same) held_[i][protocol::kHeldId] = 0.0;
  }
}

void FixLbmCouple::post_run() {
  if (Coupling::instance().over) SignalHandler::request_quit = false;  // the script continues
  marked_ = update->ntimestep;
  for (int i = 0; i < atom->nlocal; ++i) {
    std::copy_n(atom->x[i], 3, held_[i] + kPlace);
    held_[i][kRadius] = atom->radius[i];
  }
}

void FixLbmCouple::begin_recording(const std::string& record) const {
  Coupling& job = Coupling::instance();
  const int rank = comm->me;
  const std::string file = rank == 0 ? record : fmt::format("{}.{}", record, rank);
  try {
    const protocol::Bytes handshake = encode(job.session->fluid());  // came before the script
    protocol::record_to(file, job.channel, "solid", rank, handshake);
  } catch (const std::exception& e) {
    error->one(FLERR, e.what());
  }
  job.session->use(*job.channel);
}

}  // namespace dem
