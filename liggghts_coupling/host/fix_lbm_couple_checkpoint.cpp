// SPDX-License-Identifier: GPL-2.0-or-later
/// The solid's part of a checkpoint, and of what is kept at a fault.
#include <atom.h>
#include <comm.h>
#include <fmt/core.h>
#include <write_restart.h>

#include <algorithm>
#include <cmath>
#include <sstream>
#include <stdexcept>
#include <vector>

#include "liggghts_coupling/bond/bond_ledger.h"
#include "liggghts_coupling/host/coupling.h"
#include "liggghts_coupling/host/fix_lbm_couple.h"
#include "protocol/program/file_catcher.h"
#include "protocol/program/program.h"

namespace dem {

namespace {

constexpr const char* kHeading = "BPLBM solid 1";

}  // namespace

/// At a fault, where the scene has checkpoints: this interval's particles, if they are finite, so
/// that --restart=fault can go on from them where the fluid kept its part of the same interval.
void FixLbmCouple::note_failure(const std::exception& error) {
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
  protocol::SolidParts fault = coupling_->parts().beside("fault");
  try {
    write_part(fault, coupling_->interval());
  } catch (const protocol::ProgramError& second) {  // the first is what must be heard
    fmt::print(stderr, "liggghts | its last state is not kept: {}\n", second.what());
  }
}

/// LIGGGHTS' restart file of this interval.
void FixLbmCouple::write_part(protocol::SolidParts& parts, std::int64_t interval) {
  std::optional<protocol::FileCatcher> file;  // rank 0 writes for all
  if (comm->me == 0) file.emplace();
  std::string name = file ? file->path() : "";
  LAMMPS_NS::WriteRestart(lmp).write(name.data());
  if (file) parts.keep(interval, file->take());
}

void FixLbmCouple::note_particles() {
  const int types = atom->ntypes;
  std::vector<double> least(types, 1e300), most(types, 0.0);
  for (int i = 0; i < atom->nlocal; ++i) {
    const int type = atom->type[i] - 1;
    least[type] = std::min(least[type], atom->radius[i]);
    most[type] = std::max(most[type], atom->radius[i]);
  }
  MPI_Allreduce(MPI_IN_PLACE, least.data(), types, MPI_DOUBLE, MPI_MIN, world);
  MPI_Allreduce(MPI_IN_PLACE, most.data(), types, MPI_DOUBLE, MPI_MAX, world);
  for (int type = 1; type <= types; ++type) {
    if (most[type - 1] <= 0.0) continue;
    const auto& [here, first] =
        type_radii_.try_emplace(type, protocol::Range{least[type - 1], most[type - 1]});
    here->second.lo = std::min(here->second.lo, least[type - 1]);
    here->second.hi = std::max(here->second.hi, most[type - 1]);
  }
}

/// Beside the particles, a line of text a value: the coupling interval, radii by type, particles
/// that have left, loads on clumps, the ledger of bonds.
void FixLbmCouple::write_restart(FILE* file) {
  const std::string ledger = save_ledger(*bonds_, world);
  std::int64_t left = 0;
  MPI_Reduce(&left_, &left, 1, MPI_INT64_T, MPI_SUM, 0, world);
  if (comm->me != 0) return;
  std::string text = fmt::format("{}\ninterval {}\n", kHeading, coupling_->interval());
  for (const auto& [type, radii] : type_radii_)
    text += fmt::format("radii {} {} {}\n", type, radii.lo, radii.hi);
  text += fmt::format("left {}\n", left);
  for (const protocol::Load& load : coupling_->clumps().loads()) {
    const auto& [id, f, t] = load;
    text += fmt::format("clump {} {} {} {} {} {} {}\n", id, f[0], f[1], f[2], t[0], t[1], t[2]);
  }
  text += ledger;
  const int size = static_cast<int>(text.size()) + 1;  // with the zero at its end
  std::fwrite(&size, sizeof size, 1, file);
  std::fwrite(text.c_str(), 1, static_cast<std::size_t>(size), file);
}

void FixLbmCouple::restart(char* buffer) {
  const std::string text = buffer;
  std::istringstream lines(text);
  std::string heading, name;
  std::int64_t interval = -1;
  std::getline(lines, heading);
  lines >> name >> interval >> std::ws;
  const std::int64_t begin = Coupling::instance().session->fluid().first_interval;
  if (heading != kHeading || name != "interval" || !lines)
    fail("the restart file is of another version; start again without --restart");
  if (begin > 0 && interval != begin)
    fail(
        fmt::format("the restart file is of interval {}, the fluid goes on from interval {}: one "
                    "of the two parts of the checkpoint is not its own",
                    interval, begin));
  auto rest = lines.tellg();
  std::vector<protocol::Load> clumps;
  while (lines >> name && (name == "radii" || name == "left" || name == "clump")) {
    if (name == "left") {
      std::int64_t left = 0;
      lines >> left;
      left_ = comm->me == 0 ? left : 0;  // a sum over all ranks
    } else if (name == "clump") {
      auto& [id, f, t] = clumps.emplace_back();
      lines >> id >> f[0] >> f[1] >> f[2] >> t[0] >> t[1] >> t[2];
    } else {
      int type = 0;
      protocol::Range radii;
      lines >> type >> radii.lo >> radii.hi;
      type_radii_[type] = radii;
    }
    lines >> std::ws;
    rest = lines.tellg();
  }
  coupling_->clumps().set_loads(std::move(clumps));
  try {
    load_ledger(text.substr(static_cast<std::size_t>(rest)), *bonds_, world);
  } catch (const std::invalid_argument& error) {
    fail(std::string("the restart file cannot be read: ") + error.what());
  }
}

}  // namespace dem
