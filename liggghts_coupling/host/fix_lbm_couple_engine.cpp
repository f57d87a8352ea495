// SPDX-License-Identifier: GPL-2.0-or-later
/// What the coupling asks of LIGGGHTS.
#include <atom.h>
#include <comm.h>
#include <domain.h>
#include <fmt/core.h>
#include <integrate.h>
#include <modify.h>
#include <neighbor.h>
#include <update.h>

#include <array>
#include <numeric>
#include <vector>

#include "liggghts_coupling/bond/bond_book.h"
#include "liggghts_coupling/bond/leaving.h"
#include "liggghts_coupling/host/coupling.h"
#include "liggghts_coupling/host/fix_lbm_couple.h"
#include "liggghts_coupling/host/rank_grid.h"
#include "liggghts_coupling/host/script_checks.h"
#include "liggghts_coupling/host/solid_handshake.h"

namespace dem {

protocol::EngineParticles FixLbmCouple::particles() {
  return {.count = atom->nlocal,
          .dimension = domain->dimension,
          .group = groupbit,
          .frozen = frozen_groups_,
          .id = atom->tag,
          .type = atom->type,
          .mask = atom->mask,
          .radius = atom->radius,
          .mass = atom->rmass,
          .x = atom->x,
          .v = atom->v,
          .omega = atom->omega,
          .force = atom->f,
          .torque = atom->torque,
          .held = held_,
          .carrier = clumps_.carriers()};
}

std::int64_t FixLbmCouple::step_number() const {
  return update->ntimestep;
}

int FixLbmCouple::index_of(std::int64_t tag) const {
  return atom->map(static_cast<int>(tag));
}

protocol::Setting FixLbmCouple::setting() const {
  ScriptChecks(lmp).expect_box(Coupling::instance().session->fluid());
  const auto corner = [](const double* x) { return protocol::Vec3{x[0], x[1], x[2]}; };
  return {update->dt, corner(domain->boxlo), corner(domain->boxhi)};
}

/// What the script is set up to do.
protocol::Hello FixLbmCouple::hello() const {
  const protocol::Hello& fluid = Coupling::instance().session->fluid();
  protocol::Hello hello = SolidHandshake(lmp, groupbit, coupling_->substeps(), clumps_).collect();
  if (hello.buoyancy != protocol::Buoyancy::BySolid)
    hello.buoyancy = fluid.buoyancy == protocol::Buoyancy::None ? protocol::Buoyancy::None
                                                                : protocol::Buoyancy::ByFluid;
  hello.first_interval = fluid.first_interval;
  hello.schedule = fluid.schedule;
  hello.features = protocol::kCheckpoints;
  return hello;
}

/// Particles of which the fluid knows that leave the box; a clump counts once, on the first rank,
/// whichever of its spheres leave.
void FixLbmCouple::count_leaving() {
  if (!coupling_->begun()) return;
  const std::int64_t* const carrier = clumps_.carriers();
  std::vector<long long> clumps;
  for (const int i : leaving(*lmp, groupbit)) {
    if (!carrier || carrier[i] == protocol::kItself)
      ++left_;
    else if (carrier[i] != ScriptClumps::kGone)
      clumps.push_back(carrier[i]);
  }
  if (!carrier) return;
  std::vector<int> counts(comm->nprocs), begins(comm->nprocs);
  const int mine = static_cast<int>(clumps.size());
  MPI_Allgather(&mine, 1, MPI_INT, counts.data(), 1, MPI_INT, world);
  std::exclusive_scan(counts.begin(), counts.end(), begins.begin(), 0);
  std::vector<long long> all(begins.back() + counts.back());
  MPI_Allgatherv(clumps.data(), mine, MPI_LONG_LONG, all.data(), counts.data(), begins.data(),
                 MPI_LONG_LONG, world);
  for (const long long clump : all)
    if (left_clumps_.insert(clump).second && comm->me == 0) ++left_;
}

/// What there is to say of particles that have left and of bonds; of these nothing where this
/// process never had any.
std::optional<protocol::SolidReport> FixLbmCouple::report() const {
  protocol::SolidReport report{.grains_left = left_};
  const BondBook& book = *bonds_;
  const BondTally& t = book.tally;
  if (t.created + t.gone() + book.intact == 0) return report;
  report.bonds = {book.intact, t.tension, t.shear, t.left, t.lost};
  if (!book.list_wanted) return report;
  for (const auto& [a, b] : book.listed) report.list.push_back({a, b, 0});
  for (const BreakEvent& e : book.broken)
    report.list.push_back({e.first, e.second, e.mode == Break::Tension ? 1 : 2});
  return report;
}

void FixLbmCouple::note_wishes(std::uint32_t flags) {
  bonds_->list_wanted = flags & protocol::kWantBonds;
  counted_ += atom->nlocal;
}

/// Debian's LIGGGHTS cannot move the borders between its ranks. So a packing that lies in a part of
/// the box is shared as well as a grid of ranks can; where another would do better, the log says
/// so.
void FixLbmCouple::advise_on_ranks() const {
  if (comm->nprocs == 1) return;
  const std::vector<RankGrid> grids = grids_of(comm->nprocs, domain->dimension);
  std::vector<double> counts(grids.size() * static_cast<std::size_t>(comm->nprocs), 0.0);
  for (int i = 0; i < atom->nlocal; ++i) {
    std::array<double, 3> at{};
    for (int k = 0; k < 3; ++k) at[k] = (atom->x[i][k] - domain->boxlo[k]) / domain->prd[k];
    count_place(grids, at, counts);
  }
  std::vector<double> owned(static_cast<std::size_t>(comm->nprocs), 0.0);
  owned[static_cast<std::size_t>(comm->me)] = counted_;
  for (auto* sums : {&counts, &owned})
    MPI_Allreduce(MPI_IN_PLACE, sums->data(), static_cast<int>(sums->size()), MPI_DOUBLE, MPI_SUM,
                  world);
  const std::string advice = advise_grid(busiest_of(owned), grids, counts);
  if (advice.empty() || comm->me != 0) return;
  fmt::print(stderr, "liggghts | warning | {}\n", advice);
  if (logfile) fmt::print(logfile, "WARNING: {}\n", advice);  // from where it gets into the summary
}

void FixLbmCouple::note_end() {
  advise_on_ranks();
  const protocol::SolidSession& session = *Coupling::instance().session;
  if (comm->me == 0 && logfile)
    fmt::print(logfile,
               "fix lbm/couple: {} intervals, {:.6g} s of waiting for the fluid, {:.6g} s of it "
               "before the first step\n",
               coupling_->interval() - session.fluid().first_interval, session.waited(),
               waited_before_);
}

/// What a run does when it begins, in the order of LIGGGHTS' Verlet::setup, in the middle of one:
/// particles sorted and distributed, neighbours found, forces computed. Ends in `setup`.
void FixLbmCouple::set_up_again() {
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
}

}  // namespace dem
