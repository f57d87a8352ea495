// SPDX-License-Identifier: GPL-2.0-or-later
/// The solid's part of a checkpoint, and of what is kept at a fault.
#include <atom.h>
#include <comm.h>
#include <domain.h>
#include <fmt/format.h>
#include <integrate.h>
#include <modify.h>
#include <neighbor.h>
#include <update.h>
#include <write_restart.h>

#include <cmath>

#include "liggghts_coupling/host/coupling.h"
#include "liggghts_coupling/host/fix_lbm_couple.h"
#include "protocol/file_catcher.h"
#include "protocol/program.h"

namespace dem {

/// What a run does when it begins, in the order of LIGGGHTS' Verlet::setup, in the middle of one:
/// particles sorted and distributed, neighbours found, forces computed. Ends in setup() above.
void FixLbmCouple::settle_again() {
  settling_again_ = true;
  checkpoint_asked_ = false;
  modify->setup_pre_exchange();
  domain->pbc();
  domain->reset_box();
  comm->setup();
  if (neighbor->style) neighbor->setup_bins();
  comm->exchange();
  if (atom->sortfreq > 0) atom->sort();
  comm->borders();
  modify->setup_pre_neighbor();
  neighbor->build();
  neighbor->ncalls = 0;
  update->integrate->setup_minimal(0);
  settling_again_ = false;
}

void FixLbmCouple::write_checkpoint() {
  write_part(*parts_);
  MPI_Barrier(world);  // it is there before any rank says so
}

/// At a fault, where the scene has checkpoints: this interval's particles, if they are finite, so
/// that --restart=fault can go on from them where the fluid kept its part of the same interval.
void FixLbmCouple::keep_last_state(const std::exception& error) {
  const bool everywhere = comm->nprocs == 1 || dynamic_cast<const protocol::PeerFault*>(&error);
  if (!(Coupling::instance().session->fluid().features & protocol::kCheckpoints) || !everywhere)
    return;
  const protocol::Deadline deadline(error, "liggghts");
  int finite = 1;
  for (int i = 0; i < atom->nlocal; ++i)
    for (int k = 0; k < 3; ++k)
      if (!std::isfinite(atom->x[i][k] + atom->v[i][k] + atom->omega[i][k])) finite = 0;
  MPI_Allreduce(MPI_IN_PLACE, &finite, 1, MPI_INT, MPI_MIN, world);
  if (!finite) return;
  protocol::SolidParts fault = parts_->beside("fault");
  try {
    write_part(fault);
  } catch (const protocol::ProtocolError& second) {  // the first is what must be heard
    fmt::print(stderr, "liggghts | its last state is not kept: {}\n", second.what());
  }
}

/// LIGGGHTS' restart file of this interval.
void FixLbmCouple::write_part(protocol::SolidParts& parts) {
  std::optional<protocol::FileCatcher> file;  // rank 0 writes for all
  if (comm->me == 0) file.emplace();
  std::string name = file ? file->path() : "";
  LAMMPS_NS::WriteRestart(lmp).write(name.data());
  if (file) parts.keep(interval_, file->take());
}

}  // namespace dem
