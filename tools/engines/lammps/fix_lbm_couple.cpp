// SPDX-License-Identifier: GPL-2.0-or-later
/// What LAMMPS asks of a fix, and when.
#include "tools/engines/lammps/fix_lbm_couple.h"

#include <atom.h>
#include <error.h>
#include <memory.h>
#include <modify.h>
#include <timer.h>

#include <algorithm>
#include <cstdlib>
#include <string>

#include "protocol/wire/numbers.h"

namespace engine {

using namespace LAMMPS_NS::FixConst;
using protocol::kHeldId;

Coupling& Coupling::instance() {
  static Coupling coupling;
  return coupling;
}

FixLbmCouple::FixLbmCouple(LAMMPS_NS::LAMMPS* lammps, int narg, char** arg)
    : Fix(lammps, narg, arg) {
  const bool with_gravity = narg == 9 && std::string(arg[5]) == "gravity";
  const bool known = (narg == 5 || with_gravity) && std::string(arg[3]) == "every";
  const int substeps = known ? protocol::to_number<int>(arg[4]).value_or(0) : 0;
  if (substeps < 1) fail("usage: fix ID group lbm/couple every N [gravity GX GY GZ]");
  for (int k = 0; k < 3 && with_gravity; ++k) {
    const auto g = protocol::to_number<double>(arg[6 + k]);
    if (!g) fail("gravity: '" + std::string(arg[6 + k]) + "' is no number; give three, in m/s²");
    gravity_[k] = *g;
  }
  Coupling& job = Coupling::instance();
  Engine& self = *this;  // a private base
  coupling_.emplace(self, *job.session, job, substeps);
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

void FixLbmCouple::fail(const std::string& text) const {
  error->all(FLERR, "fix lbm/couple: " + text);
  std::abort();  // not reached: error->all ends the program
}

int FixLbmCouple::setmask() {
  return PRE_EXCHANGE | POST_FORCE | END_OF_STEP;
}

void FixLbmCouple::init() {
  if (!atom->radius_flag || !atom->rmass_flag || !atom->omega_flag || !atom->torque_flag)
    fail("needs spheres; use atom_style sphere");
  frozen_groups_ = 0;
  for (int i = 0; i < modify->nfix; ++i) {
    const std::string style = modify->fix[i]->style;
    if (style == "freeze" || style == "setforce") frozen_groups_ |= modify->fix[i]->groupbit;
  }
}

/// The end of LAMMPS' set-up: of a run, or, within one, of `set_up_again`. A later run goes on with
/// the loads that are held; the fluid sees what the script did to the particles in between with the
/// next states.
void FixLbmCouple::setup(int) {
  if (coupling_->setting_up_again())
    coupling_->resume();
  else if (Coupling::instance().over)
    fail("the fluid has reached its end: no run may follow");
  else if (!Coupling::instance().agreed)
    coupling_->begin(hello());
  coupling_->add_loads();
}

void FixLbmCouple::end_of_step() {
  if (Coupling::instance().over) return;
  coupling_->end_step();
  if (Coupling::instance().over) timer->force_timeout();  // leaves the run after this step
}

// ---- what is kept of each particle travels with it ------------------------------------------

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
  buffer[0] = kColumns - kHeldId + 1;  // LAMMPS' convention: a fix's record begins with its length
  std::copy(held_[i] + kHeldId, held_[i] + kColumns, buffer + 1);
  return kColumns - kHeldId + 1;
}
void FixLbmCouple::unpack_restart(int i, int nth) {
  const double* record = atom->extra[i];
  for (int n = 0; n < nth; ++n) record += static_cast<int>(record[0]);
  set_arrays(i);
  std::copy_n(record + 1, kColumns - kHeldId, held_[i] + kHeldId);
}

}  // namespace engine
