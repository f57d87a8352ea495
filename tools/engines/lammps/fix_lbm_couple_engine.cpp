// SPDX-License-Identifier: GPL-2.0-or-later
/// What the coupling asks of LAMMPS.
#include "tools/engines/lammps/fix_lbm_couple.h"

#include <atom.h>
#include <bond.h>
#include <comm.h>
#include <domain.h>
#include <force.h>
#include <modify.h>
#include <neighbor.h>
#include <output.h>
#include <pair.h>
#include <update.h>

#include "protocol/program/file_catcher.h"

namespace engine {

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
          .held = held_};
}

std::int64_t FixLbmCouple::step_number() const {
  return update->ntimestep;
}

int FixLbmCouple::index_of(std::int64_t tag) const {
  return atom->map(static_cast<int>(tag));
}

protocol::Setting FixLbmCouple::setting() const {
  const auto corner = [](const double* x) { return protocol::Vec3{x[0], x[1], x[2]}; };
  return {update->dt, corner(domain->boxlo), corner(domain->boxhi)};
}

protocol::Hello FixLbmCouple::hello() const {
  const protocol::Hello& fluid = Coupling::instance().session->fluid();
  protocol::Hello hello;
  hello.role = protocol::Role::Solid;
  hello.program = "lammps_engine";
  hello.program_version = BPLBM_VERSION;
  hello.dimension = static_cast<std::uint32_t>(domain->dimension);
  for (int k = 0; k < 3; ++k) {
    hello.box_lo[k] = domain->boxlo[k];
    hello.box_hi[k] = domain->boxhi[k];
    hello.periodic[k] = domain->periodicity[k] != 0;
  }
  hello.depth = hello.box_hi[2] - hello.box_lo[2];
  hello.step = update->dt;
  hello.solid_steps = static_cast<std::uint32_t>(coupling_->substeps());
  hello.buoyancy = fluid.buoyancy == protocol::Buoyancy::None ? protocol::Buoyancy::None
                                                              : protocol::Buoyancy::ByFluid;
  hello.gravity = gravity_;
  hello.first_interval = fluid.first_interval;
  // set_up_again knows the forces of granular scenes only
  const bool others = force->angle || force->dihedral || force->improper || force->kspace;
  if (!others) hello.features = protocol::kCheckpoints;
  std::int64_t count = 0;
  for (int i = 0; i < atom->nlocal; ++i) count += (atom->mask[i] & groupbit) != 0;
  MPI_Allreduce(MPI_IN_PLACE, &count, 1, MPI_INT64_T, MPI_SUM, world);
  hello.particles = count;
  return hello;
}

/// Before LAMMPS looks for neighbours: what the fluid would refuse, with the fix that does it.
void FixLbmCouple::setup_pre_exchange() {
  if (coupling_->setting_up_again()) return;
  const protocol::Hello box = hello();
  const protocol::EngineParticles p = particles();
  for (int i = 0; i < modify->nfix; ++i) {
    const LAMMPS_NS::Fix& fix = *modify->fix[i];
    if (!std::string(fix.style).starts_with("rigid")) continue;
    if (const auto pair = find_overlap(balls_of(p, fix.groupbit), box, protocol::Depth::Surface))
      throw protocol::ProgramError(
          std::string("fix ") + fix.id + " " + fix.style +
              " joins spheres that overlap: " + describe(*pair) +
              ". Such clumps cannot couple yet: the fluid would count buoyancy and the fluid "
              "inside once a sphere. Use spheres that do not overlap",
          protocol::kBadInput);
  }
  if (const auto pair = find_overlap(balls_of(p, groupbit), box))
    throw protocol::ProgramError(describe(*pair) +
                                     "; the centre of one lies in the other: "
                                     "correct their places or diameters",
                                 protocol::kBadInput);
}

/// What a run does when it begins, in the order of LAMMPS' Verlet::setup, in the middle of one:
/// particles sorted and distributed, neighbours found, forces computed. Ends in `setup`.
void FixLbmCouple::set_up_again() {
  update->setupflag = 1;
  modify->setup_pre_exchange();
  domain->pbc();
  domain->reset_box();
  comm->setup();
  if (neighbor->style) neighbor->setup_bins();
  comm->exchange();
  if (atom->sortfreq > 0) atom->sort();
  comm->borders();
  modify->setup_pre_neighbor();
  neighbor->build(1);
  modify->setup_post_neighbor();
  neighbor->ncalls = 0;
  for (int i = 0; i < atom->nlocal + atom->nghost; ++i)
    for (int k = 0; k < 3; ++k) atom->f[i][k] = atom->torque[i][k] = 0.0;
  modify->setup_pre_force(0);
  if (force->pair && force->pair->compute_flag) force->pair->compute(0, 0);
  if (force->bond) force->bond->compute(0, 0);
  modify->setup_pre_reverse(0, 0);
  if (force->newton) comm->reverse_comm();
  modify->setup(0);
  update->setupflag = 0;
}

/// LAMMPS' restart file of this interval, by the command for periodic ones, which puts the step in
/// place of the star.
void FixLbmCouple::write_part(protocol::SolidParts& parts, std::int64_t interval) {
  const std::string step = "." + std::to_string(update->ntimestep);
  std::optional<protocol::FileCatcher> file;  // rank 0 writes for all
  if (comm->me == 0) file.emplace(step);
  std::string never = "0", every = std::to_string(MAXSMALLINT), name = "none.*";
  if (file) name = file->path().substr(0, file->path().size() - step.size()) + ".*";
  char* on[] = {every.data(), name.data()};
  char* off[] = {never.data()};
  output->create_restart(2, on);
  output->write_restart(update->ntimestep);
  output->create_restart(1, off);
  if (file) parts.keep(interval, file->take());
}

}  // namespace engine
