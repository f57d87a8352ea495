// SPDX-License-Identifier: GPL-2.0-or-later
#include "tools/engines/lammps/fix_lbm_couple.h"

#include <atom.h>
#include <bond.h>
#include <comm.h>
#include <domain.h>
#include <error.h>
#include <force.h>
#include <memory.h>
#include <modify.h>
#include <neighbor.h>
#include <output.h>
#include <pair.h>
#include <timer.h>
#include <update.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <string>
#include <utility>

#include "protocol/program/file_catcher.h"
#include "protocol/wire/numbers.h"

namespace engine {

using namespace LAMMPS_NS::FixConst;

Coupling& Coupling::instance() {
  static Coupling coupling;
  return coupling;
}

FixLbmCouple::FixLbmCouple(LAMMPS_NS::LAMMPS* lammps, int narg, char** arg)
    : Fix(lammps, narg, arg) {
  const bool with_gravity = narg == 9 && std::string(arg[5]) == "gravity";
  if (!(narg == 5 || with_gravity) || std::string(arg[3]) != "every" ||
      (substeps_ = protocol::to_number<int>(arg[4]).value_or(0)) < 1)
    error->all(FLERR, std::string("fix lbm/couple: usage: fix ID group lbm/couple every N [gravity "
                                  "GX GY GZ]"));
  if (with_gravity)
    for (int k = 0; k < 3; ++k) {
      const auto g = protocol::to_number<double>(arg[6 + k]);
      if (!g)
        error->all(FLERR, std::string("fix lbm/couple: gravity: '") + arg[6 + k] +
                              "' is no number; give three, in m/s²");
      gravity_[k] = *g;
    }
  nevery = 1;
  create_attribute = 1;
  restart_peratom = 1;
  grow_arrays(atom->nmax);
  atom->add_callback(LAMMPS_NS::Atom::GROW);     // held loads follow their particles
  atom->add_callback(LAMMPS_NS::Atom::RESTART);  // epochs go into restart files
  for (int i = 0; i < atom->nlocal; ++i) set_arrays(i);
}

FixLbmCouple::~FixLbmCouple() {
  atom->delete_callback(id, LAMMPS_NS::Atom::GROW);
  atom->delete_callback(id, LAMMPS_NS::Atom::RESTART);
  memory->destroy(held_);
}

int FixLbmCouple::setmask() {
  return PRE_EXCHANGE | POST_FORCE | END_OF_STEP;
}

void FixLbmCouple::init() {
  if (!atom->radius_flag || !atom->rmass_flag || !atom->omega_flag || !atom->torque_flag)
    error->all(FLERR, std::string("fix lbm/couple: needs spheres; use atom_style sphere"));
  held_still_ = 0;
  for (int i = 0; i < modify->nfix; ++i) {
    const std::string style = modify->fix[i]->style;
    if (style == "freeze" || style == "setforce") held_still_ |= modify->fix[i]->groupbit;
  }
}

std::vector<protocol::Ball> FixLbmCouple::balls(int group) const {
  std::vector<protocol::Ball> balls;
  for (int i = 0; i < atom->nlocal; ++i) {
    const double* x = atom->x[i];
    const bool usable = std::isfinite(x[0] + x[1] + x[2]) && atom->radius[i] > 0.0;
    if ((atom->mask[i] & group) && usable)
      balls.push_back({atom->tag[i], {x[0], x[1], x[2]}, atom->radius[i]});
  }
  return balls;
}

/// Before LAMMPS looks for neighbours: what the fluid would refuse, with the fix that does it.
void FixLbmCouple::setup_pre_exchange() {
  if (settling_again_) return;
  const protocol::Hello box = hello();
  for (int i = 0; i < modify->nfix; ++i) {
    const LAMMPS_NS::Fix& fix = *modify->fix[i];
    if (!std::string(fix.style).starts_with("rigid")) continue;
    if (const auto pair = find_overlap(balls(fix.groupbit), box, protocol::Depth::Surface))
      throw protocol::ProgramError(
          std::string("fix ") + fix.id + " " + fix.style +
              " joins spheres that overlap: " + describe(*pair) +
              ". Such clumps cannot couple yet: the fluid would count buoyancy and the fluid "
              "inside once a sphere. Use spheres that do not overlap",
          protocol::kBadInput);
  }
  if (const auto pair = find_overlap(balls(groupbit), box))
    throw protocol::ProgramError(describe(*pair) +
                                     "; the centre of one lies in the other: "
                                     "correct their places or diameters",
                                 protocol::kBadInput);
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
  hello.solid_steps = static_cast<std::uint32_t>(substeps_);
  hello.buoyancy = fluid.buoyancy == protocol::Buoyancy::None ? protocol::Buoyancy::None
                                                              : protocol::Buoyancy::ByFluid;
  hello.gravity = gravity_;
  hello.first_interval = fluid.first_interval;
  // settle_again knows the forces of granular scenes only
  const bool others = force->angle || force->dihedral || force->improper || force->kspace;
  if (!others) hello.features = protocol::kCheckpoints;
  std::int64_t count = 0;
  for (int i = 0; i < atom->nlocal; ++i) count += (atom->mask[i] & groupbit) != 0;
  MPI_Allreduce(MPI_IN_PLACE, &count, 1, MPI_INT64_T, MPI_SUM, world);
  hello.particles = count;
  return hello;
}

/// A later run goes on with the loads that are held; the fluid sees what the script did to the
/// particles in between with the next states.
void FixLbmCouple::setup(int vflag) {
  Coupling& coupling = Coupling::instance();
  if (settling_again_) {
    const bool write = std::exchange(checkpoint_asked_, false);
    if (write) write_part();
    exchange(false, write ? protocol::kCheckpoint : protocol::kContinue);
    post_force(vflag);
    return;
  }
  if (coupling.over)
    error->all(FLERR, std::string("fix lbm/couple: the fluid has reached its end: no run may "
                                  "follow"));
  if (!coupling.agreed) {
    coupling.session->agree(hello());
    coupling.agreed = true;
    interval_ = coupling.session->fluid().first_interval;
    parts_ = protocol::SolidParts::of(coupling.session->fluid());
    first_step_ = update->ntimestep;
    exchange(false);
  }
  post_force(vflag);
}

void FixLbmCouple::post_force(int) {
  for (int i = 0; i < atom->nlocal; ++i) {
    if (!(atom->mask[i] & groupbit)) continue;
    for (int k = 0; k < 3; ++k) {
      atom->f[i][k] += held_[i][k];
      atom->torque[i][k] += held_[i][3 + k];
    }
  }
}

void FixLbmCouple::end_of_step() {
  if (Coupling::instance().over || (update->ntimestep - first_step_) % substeps_ != 0) return;
  ++interval_;
  if (settle_asked_ || checkpoint_asked_)
    settle_again();
  else
    exchange(true);
  if (Coupling::instance().over) timer->force_timeout();  // leaves the run after this step
}

/// @param add_change  the force of the step just done acts in the next first half-step as well:
///                    replace the old load by the new one there (not in particles whose forces
///                    a later fix has set: those would creep)
/// @param flags       of the states
void FixLbmCouple::exchange(bool add_change, std::uint32_t flags) {
  std::vector<protocol::State> states;
  std::vector<protocol::Shape> shapes;
  std::vector<int> local;
  const double factor = domain->dimension == 2 ? 0.5 : 0.4;  // inertia of a disc, of a sphere
  for (int i = 0; i < atom->nlocal; ++i) {
    if (!(atom->mask[i] & groupbit)) continue;
    const double *x = atom->x[i], *v = atom->v[i], *w = atom->omega[i];
    const double r = atom->radius[i], m = atom->rmass[i];
    states.push_back({atom->tag[i], {x[0], x[1], x[2]}, {v[0], v[1], v[2]}, {w[0], w[1], w[2]}});
    if (held_[i][kId] != static_cast<double>(atom->tag[i])) {  // the id has come to this particle
      held_[i][kId] = static_cast<double>(atom->tag[i]);
      held_[i][kEpoch] = static_cast<double>(interval_);
    }
    shapes.push_back({atom->tag[i], r, m, factor * m * r * r, atom->type[i],
                      static_cast<std::int64_t>(held_[i][kEpoch])});
    local.push_back(i);
  }
  Coupling& coupling = Coupling::instance();
  const double time = static_cast<double>(interval_) * update->dt * substeps_;
  if (stop_asked_) flags |= protocol::kLast;
  const auto corner = [](const double* x) { return protocol::Vec3{x[0], x[1], x[2]}; };
  coupling.session->set({update->dt, corner(domain->boxlo), corner(domain->boxhi)});
  const auto reply = coupling.session->exchange({interval_, time, flags}, states, shapes);
  coupling.over = stop_asked_;
  if (coupling.over) return;
  stop_asked_ = reply.flags & protocol::kStop;
  settle_asked_ = reply.flags & protocol::kSettle;
  checkpoint_asked_ = reply.flags & protocol::kCheckpoint;
  for (std::size_t n = 0; n < local.size(); ++n) {
    const int i = local[n];
    const protocol::Load& load = reply.loads[n];
    for (int k = 0; k < 3; ++k) {
      if (add_change && !(atom->mask[i] & held_still_)) {
        atom->f[i][k] += load.force[k] - held_[i][k];
        atom->torque[i][k] += load.torque[k] - held_[i][3 + k];
      }
      held_[i][k] = load.force[k];
      held_[i][3 + k] = load.torque[k];
    }
  }
}

/// What a run does when it begins, in the order of LAMMPS' Verlet::setup, in the middle of one:
/// particles sorted and distributed, neighbours found, forces computed. Ends in setup() above.
void FixLbmCouple::settle_again() {
  settling_again_ = true;
  settle_asked_ = false;
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
  settling_again_ = false;
}

/// LAMMPS' restart file of this interval, by the command for periodic ones, which puts the step in
/// place of the star.
void FixLbmCouple::write_part() {
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
  if (file) parts_->keep(interval_, file->take());
  MPI_Barrier(world);  // it is there before any rank says so
}

void FixLbmCouple::grow_arrays(int n) {
  memory->grow(held_, n, kColumns, "lbm/couple:held");
}
void FixLbmCouple::copy_arrays(int from, int to, int) {
  std::copy_n(held_[from], kColumns, held_[to]);
}
void FixLbmCouple::set_arrays(int i) {
  std::fill_n(held_[i], kColumns, 0.0);
}
int FixLbmCouple::pack_exchange(int i, double* buffer) {
  std::copy_n(held_[i], kColumns, buffer);
  return kColumns;
}
int FixLbmCouple::unpack_exchange(int i, double* buffer) {
  std::copy_n(buffer, kColumns, held_[i]);
  return kColumns;
}

int FixLbmCouple::pack_restart(int i, double* buffer) {
  buffer[0] = kColumns - kId + 1;  // LAMMPS' convention: a fix's record begins with its length
  std::copy(held_[i] + kId, held_[i] + kColumns, buffer + 1);
  return kColumns - kId + 1;
}
void FixLbmCouple::unpack_restart(int i, int nth) {
  const double* record = atom->extra[i];
  for (int n = 0; n < nth; ++n) record += static_cast<int>(record[0]);
  set_arrays(i);
  std::copy_n(record + 1, kColumns - kId, held_[i] + kId);
}

}  // namespace engine
