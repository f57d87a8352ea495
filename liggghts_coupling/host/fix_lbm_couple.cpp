// SPDX-License-Identifier: GPL-2.0-or-later
/// What LIGGGHTS asks of a fix, and when.
#include "liggghts_coupling/host/fix_lbm_couple.h"

#include <atom.h>
#include <comm.h>
#include <error.h>
#include <fmt/core.h>
#include <modify.h>
#include <signal_handling.h>
#include <update.h>

#include <cstdlib>

#include "liggghts_coupling/bond/bond_book.h"
#include "liggghts_coupling/host/coupling.h"
#include "liggghts_coupling/host/fix_lbm_couple_arguments.h"
#include "liggghts_coupling/host/script_checks.h"
#include "liggghts_coupling/host/solid_handshake.h"
#include "protocol/program/watch.h"

namespace dem {

using namespace LAMMPS_NS::FixConst;
namespace SignalHandler = LAMMPS_NS::SignalHandler;

FixLbmCouple::FixLbmCouple(LAMMPS_NS::LAMMPS* lammps, int narg, char** arg)
    : Fix(lammps, narg, arg) {
  const CoupleArguments arguments =
      read_arguments(narg, arg, [this](const std::string& text) { fail(text); });
  Coupling& job = Coupling::instance();
  if (!job.session)
    fail(
        "no fluid program was started beside liggghts; start: mpirun -np 1 lbm scene.toml : -np 1 "
        "liggghts -in FILE");
  Engine& self = *this;  // a private base
  coupling_.emplace(self, *job.session, job, arguments.substeps);
  nevery = 1;
  restart_global = 1;
  restart_peratom = 1;
  create_attribute = 1;
  peratom_flag = 1;
  size_peratom_cols = kLoads;
  peratom_freq = 1;
  grow_arrays(atom->nmax);
  atom->add_callback(0);  // held loads follow their particles …
  atom->add_callback(1);  // … and go into restart files
  for (int i = 0; i < atom->nlocal; ++i) set_arrays(i);
  if (arguments.timeout) {
    job.session->set_timeout(*arguments.timeout);
    protocol::limit_waits(*arguments.timeout);
  }
  bonds_->list_wanted = true;  // with the first states, too
  if (!arguments.record.empty()) begin_recording(arguments.record);
}

void FixLbmCouple::fail(const std::string& text) const {
  error->all(FLERR, ("fix " + std::string(id) + " lbm/couple: " + text).c_str());
  std::abort();  // not reached: error->all ends the program
}

int FixLbmCouple::setmask() {
  return PRE_EXCHANGE | POST_FORCE | END_OF_STEP;
}

void FixLbmCouple::init() {
  if (!atom->radius_flag || !atom->rmass_flag || !atom->omega_flag || !atom->torque_flag)
    fail("needs spheres; use atom_style granular");
  if (modify->n_fixes_style("lbm/couple") != 1) fail("only one fix lbm/couple may exist");
  if (!coupling_->begun()) bonds_->list_wanted = true;  // for the picture at t = 0
  const int here = modify->my_index(this);
  frozen_groups_ = 0;
  for (int i = 0; i < modify->nfix; ++i) {
    const std::string style = modify->fix[i]->style;
    const bool holds = style == "freeze" || style == "setforce";
    if (i < here && (holds || style == "enforce2d"))
      fail(fmt::format("must stand before fix {} {}, which would not see the loads",
                       modify->fix[i]->id, style));
    if (holds) frozen_groups_ |= modify->fix[i]->groupbit;
  }
  clumps_.find();
  if (clumps_.has_rigid() &&
      Coupling::instance().session->fluid().features & protocol::kCheckpoints)
    fail(
        "a fix rigid keeps nothing of its bodies in restart files: leave out run.checkpoint_every "
        "of the scene, or use fix multisphere");
  if (Coupling::instance().session->fluid().features & protocol::kCheckpoints) note_particles();
}

/// Before LIGGGHTS looks for neighbours, which may take it minutes.
void FixLbmCouple::setup_pre_exchange() {
  count_leaving();
  if (coupling_->setting_up_again()) return;
  const ScriptChecks checks(lmp);
  checks.refuse_other_shapes();
  if (clumps_.in_part(groupbit))
    fail("its group holds some spheres of clumps and leaves others out; give it all of them");
  checks.refuse_overlaps(groupbit, clumps_.carriers());
  clumps_.refuse_wrong_weight();
}

/// The end of LIGGGHTS' set-up: of a run, or, within one, of `set_up_again`.
void FixLbmCouple::setup(int) {
  if (coupling_->setting_up_again())
    coupling_->resume();
  else if (Coupling::instance().over)
    fail(
        "the fluid has reached its end and left: no run may follow; let all together have "
        "${solid_steps_total} steps");
  else if (!coupling_->begun())
    begin();
  else
    go_on();
  coupling_->add_loads(protocol::Moment::SetUp);
}

void FixLbmCouple::begin() {
  Coupling& job = Coupling::instance();
  if (job.agreed) fail("was removed and made anew: keep the first one for all runs");
  const protocol::Hello mine = hello();
  if (*mine.particles > 0)
    SolidHandshake(lmp, groupbit, coupling_->substeps(), clumps_).expect_motion();
  step_ = update->ntimestep;
  time_step_ = update->dt;
  bonds_->first_step = static_cast<long>(step_ - mine.first_interval * coupling_->substeps());
  coupling_->begin(mine);
  waited_before_ = job.session->waited();
}

void FixLbmCouple::end_of_step() {
  step_ = update->ntimestep;
  if (Coupling::instance().over) return;
  if (update->dt != time_step_) ScriptChecks(lmp).refuse_step(time_step_);
  coupling_->end_step();
  if (Coupling::instance().over)
    SignalHandler::request_quit = true;  // leaves the run after this step
}

}  // namespace dem
