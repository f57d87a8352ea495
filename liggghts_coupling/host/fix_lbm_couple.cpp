// SPDX-License-Identifier: GPL-2.0-or-later
#include "liggghts_coupling/host/fix_lbm_couple.h"

#include <atom.h>
#include <comm.h>
#include <domain.h>
#include <error.h>
#include <fmt/format.h>
#include <memory.h>
#include <modify.h>
#include <signal_handling.h>
#include <update.h>

#include <cmath>
#include <cstring>
#include <utility>

#include "liggghts_coupling/bond/bond_book.h"
#include "liggghts_coupling/bond/leaving.h"
#include "liggghts_coupling/host/coupling.h"
#include "liggghts_coupling/host/script_checks.h"
#include "liggghts_coupling/host/solid_hello.h"
#include "protocol/program/program.h"
#include "protocol/program/watch.h"
#include "protocol/transport/trace.h"
#include "protocol/wire/agreement.h"
#include "protocol/wire/numbers.h"

namespace dem {

using namespace LAMMPS_NS::FixConst;
namespace SignalHandler = LAMMPS_NS::SignalHandler;

FixLbmCouple::FixLbmCouple(LAMMPS_NS::LAMMPS* lammps, int narg, char** arg)
    : Fix(lammps, narg, arg) {
  parse(narg, arg);
  if (!Coupling::instance().session)
    fail(
        "no fluid program was started beside liggghts; start: mpirun -np 1 lbm scene.toml : -np 1 "
        "liggghts -in FILE");
  nevery = 1;
  restart_global = 1;
  restart_peratom = 1;
  create_attribute = 1;
  peratom_flag = 1;
  size_peratom_cols = kValues;
  peratom_freq = 1;
  grow_arrays(atom->nmax);
  atom->add_callback(0);  // held loads follow their particles …
  atom->add_callback(1);  // … and go into restart files
  for (int i = 0; i < atom->nlocal; ++i) set_arrays(i);
  if (timeout_) {
    Coupling::instance().session->set_timeout(*timeout_);
    protocol::limit_waits(*timeout_);
  }
  BondBook::instance().list_wanted = true;  // with the first states, too
  if (!record_.empty()) begin_recording();
}

FixLbmCouple::~FixLbmCouple() {
  atom->delete_callback(id, 0);
  atom->delete_callback(id, 1);
  memory->destroy(held_);
}

void FixLbmCouple::fail(const std::string& text) const {
  error->all(FLERR, ("fix " + std::string(id) + " lbm/couple: " + text).c_str());
  std::abort();  // not reached: error->all ends the program
}

void FixLbmCouple::parse(int narg, char** arg) {
  const std::string usage = "; usage: fix ID group lbm/couple every N [timeout S] [record FILE]";
  for (int i = 3; i < narg; i += 2) {
    const std::string key = arg[i];
    if (i + 1 == narg) fail("'" + key + "' has no value" + usage);
    const std::string value = arg[i + 1];
    if (key == "every") {
      substeps_ = protocol::to_number<int>(value).value_or(0);
      if (substeps_ < 1)
        fail("'every " + value + "': give a whole number of at least 1, e.g. ${substeps}" + usage);
    } else if (key == "timeout") {
      timeout_ = protocol::to_number<double>(value).value_or(0.0);
      if (!(*timeout_ > 0.0))
        fail("'timeout " + value + "': give a positive number of seconds" + usage);
    } else if (key == "record") {
      record_ = value;
    } else {
      fail("'" + key + "' is no keyword" + usage);
    }
  }
  if (substeps_ < 1) fail("lacks 'every N'" + usage);
}

void FixLbmCouple::begin_recording() const {
  Coupling& coupling = Coupling::instance();
  const int rank = comm->me;
  const std::string file = rank == 0 ? record_ : fmt::format("{}.{}", record_, rank);
  try {
    auto writer = std::make_unique<protocol::TraceWriter>(file, "solid", rank,
                                                          coupling.channel->remote_size());
    for (int r = 0; r < coupling.channel->remote_size(); ++r)  // came before this script was read
      writer->record(protocol::Direction::Received, r, encode(coupling.session->fluid()));
    coupling.channel =
        protocol::make_recording_channel(std::move(coupling.channel), std::move(writer));
  } catch (const std::exception& e) {
    error->one(FLERR, e.what());
  }
  coupling.session->use(*coupling.channel);
}

int FixLbmCouple::setmask() {
  return PRE_EXCHANGE | POST_FORCE | END_OF_STEP;
}

void FixLbmCouple::init() {
  if (!atom->radius_flag || !atom->rmass_flag || !atom->omega_flag || !atom->torque_flag)
    fail("needs spheres; use atom_style granular");
  if (modify->n_fixes_style("lbm/couple") != 1) fail("only one fix lbm/couple may exist");
  if (!set_up_) BondBook::instance().list_wanted = true;  // for the picture at t = 0
  const int here = modify->my_index(this);
  held_still_ = 0;
  for (int i = 0; i < modify->nfix; ++i) {
    const std::string style = modify->fix[i]->style;
    const bool holds = style == "freeze" || style == "setforce";
    if (i < here && (holds || style == "enforce2d"))
      fail(fmt::format("must stand before fix {} {}, which would not see the loads",
                       modify->fix[i]->id, style));
    if (holds) held_still_ |= modify->fix[i]->groupbit;
  }
  if (Coupling::instance().session->fluid().features & protocol::kCheckpoints) note_particles();
}

/// Before LIGGGHTS looks for neighbours, which may take it minutes.
void FixLbmCouple::setup_pre_exchange() {
  count_leaving();
  if (settling_again_) return;
  const ScriptChecks checks(lmp);
  checks.refuse_clumps();
  checks.refuse_overlaps(groupbit);
}

void FixLbmCouple::setup(int vflag) {
  if (settling_again_) {
    const bool write = std::exchange(checkpoint_asked_, false);
    if (write) write_checkpoint();
    send_states(write ? protocol::kCheckpoint : protocol::kContinue);
    if (!overlapped_ && !Coupling::instance().over) take_loads(false);
    post_force(vflag);
    return;
  }
  if (Coupling::instance().over)
    fail(
        "the fluid has reached its end and left: no run may follow; let all together have "
        "${solid_steps_total} steps");
  if (!set_up_)
    begin();
  else
    go_on();
  post_force(vflag);
}

/// What the script is set up to do.
protocol::Hello FixLbmCouple::hello() const {
  const protocol::Hello& fluid = Coupling::instance().session->fluid();
  protocol::Hello hello = SolidHello(lmp, groupbit, substeps_).collect();
  if (hello.buoyancy != protocol::Buoyancy::BySolid)
    hello.buoyancy = fluid.buoyancy == protocol::Buoyancy::None ? protocol::Buoyancy::None
                                                                : protocol::Buoyancy::ByFluid;
  hello.first_interval = fluid.first_interval;
  hello.schedule = fluid.schedule;
  hello.features = protocol::kCheckpoints;
  return hello;
}

void FixLbmCouple::begin() {
  Coupling& coupling = Coupling::instance();
  if (coupling.agreed) fail("was removed and made anew: keep the first one for all runs");
  const protocol::Hello& fluid = coupling.session->fluid();
  const protocol::Hello mine = hello();
  if (*mine.particles > 0) SolidHello(lmp, groupbit, substeps_).expect_motion();
  interval_ = fluid.first_interval;
  overlapped_ = fluid.schedule == protocol::Schedule::Overlapped;
  parts_ = protocol::SolidParts::of(fluid);
  coupling.session->agree(mine);
  coupling.agreed = set_up_ = true;
  first_step_ = step_ = update->ntimestep;
  BondBook::instance().first_step = static_cast<long>(first_step_ - interval_ * substeps_);
  time_step_ = update->dt;
  send_states();
  // The first interval is serial in either schedule, unless a checkpoint has the loads to begin
  // with.
  if (!overlapped_ || interval_ == 0) take_loads(false);
  waited_before_ = coupling.session->waited();
}

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
    if (!same) held_[i][kId] = 0.0;
  }
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
  step_ = update->ntimestep;
  if (Coupling::instance().over) return;
  if (update->dt != time_step_) ScriptChecks(lmp).refuse_step(time_step_);
  if ((update->ntimestep - first_step_) % substeps_ != 0) return;
  ++interval_;
  if (underway_) take_loads(true);  // overlapped: of the interval that ends, for the next one
  if (settle_asked_ || checkpoint_asked_) {
    settle_again();
  } else {
    send_states();
    if (!overlapped_ && !Coupling::instance().over) take_loads(true);
  }
  if (Coupling::instance().over)
    SignalHandler::request_quit = true;  // leaves the run after this step
}

void FixLbmCouple::post_run() {
  if (Coupling::instance().over) SignalHandler::request_quit = false;  // the script continues
  marked_ = update->ntimestep;
  for (int i = 0; i < atom->nlocal; ++i) {
    std::copy_n(atom->x[i], 3, held_[i] + kPlace);
    held_[i][kRadius] = atom->radius[i];
  }
}

void FixLbmCouple::gather() {
  states_.clear();
  shapes_.clear();
  local_.clear();
  const double factor = domain->dimension == 2 ? 0.5 : 0.4;  // inertia of a disc, of a sphere
  for (int i = 0; i < atom->nlocal; ++i) {
    if (!(atom->mask[i] & groupbit)) continue;
    const double *x = atom->x[i], *v = atom->v[i], *w = atom->omega[i];
    const double r = atom->radius[i], m = atom->rmass[i];
    states_.push_back({atom->tag[i], {x[0], x[1], x[2]}, {v[0], v[1], v[2]}, {w[0], w[1], w[2]}});
    if (held_[i][kId] != atom->tag[i]) {  // this id has come to this particle
      held_[i][kId] = atom->tag[i];
      held_[i][kEpoch] = static_cast<double>(interval_);
    }
    shapes_.push_back({atom->tag[i], r, m, factor * m * r * r, atom->type[i],
                       static_cast<std::int64_t>(held_[i][kEpoch])});
    local_.push_back(i);
  }
}

/// Particles of which the fluid knows that leave the box.
void FixLbmCouple::count_leaving() {
  if (set_up_) left_ += static_cast<std::int64_t>(leaving(*lmp, groupbit).size());
}

/// What there is to say of particles that have left and of bonds; of these nothing where this
/// process never had any.
protocol::SolidReport FixLbmCouple::report() const {
  protocol::SolidReport report{.grains_left = left_};
  const BondBook& book = BondBook::instance();
  const BondTally& t = book.tally;
  if (t.created + t.gone() + book.intact == 0) return report;
  report.bonds = {book.intact, t.tension, t.shear, t.left, t.lost};
  if (!book.list_wanted) return report;
  for (const auto& [a, b] : book.listed) report.list.push_back({a, b, 0});
  for (const BreakEvent& e : book.broken)
    report.list.push_back({e.first, e.second, e.mode == Break::Tension ? 1 : 2});
  return report;
}

void FixLbmCouple::send_states(std::uint32_t flags) {
  Coupling& coupling = Coupling::instance();
  ScriptChecks(lmp).expect_box(coupling.session->fluid());
  gather();
  const double interval = update->dt * substeps_;
  if (stop_asked_) flags |= protocol::kLast;
  const auto corner = [](const double* x) { return protocol::Vec3{x[0], x[1], x[2]}; };
  coupling.session->set({update->dt, corner(domain->boxlo), corner(domain->boxhi)});
  coupling.session->send({interval_, static_cast<double>(interval_) * interval, flags}, states_,
                         shapes_, report());
  coupling.over = stop_asked_;
  underway_ = !stop_asked_;
  if (coupling.over && comm->me == 0 && logfile)
    fmt::print(logfile,
               "fix lbm/couple: {} intervals, {:.6g} s of waiting for the fluid, {:.6g} s of it "
               "before the first step\n",
               interval_ - coupling.session->fluid().first_interval, coupling.session->waited(),
               waited_before_);
}

protocol::SolidSession::Reply FixLbmCouple::collect() {
  try {
    return Coupling::instance().session->collect();
  } catch (const std::exception& error) {
    keep_last_state(error);
    throw;
  }
}

/// @param add_change  the forces of the step just done are still in f and will act in the next
///                    first half-step: replace the old load by the new one there too, so that the
///                    impulse of an interval is its load times its length (not in particles whose
///                    forces a later fix has set: those would creep)
void FixLbmCouple::take_loads(bool add_change) {
  const auto reply = collect();
  underway_ = false;
  stop_asked_ = reply.flags & protocol::kStop;
  settle_asked_ = reply.flags & protocol::kSettle;
  checkpoint_asked_ = reply.flags & protocol::kCheckpoint;
  BondBook::instance().list_wanted = reply.flags & protocol::kWantBonds;
  if (!overlapped_) {
    for (std::size_t n = 0; n < local_.size(); ++n) hold(local_[n], reply.loads[n], add_change);
    return;
  }
  std::vector<protocol::Load> orphans;  // of particles that have left this rank since
  for (const protocol::Load& load : reply.loads) {
    const int i = atom->map(static_cast<int>(load.id));
    if (i >= 0 && i < atom->nlocal)
      hold(i, load, add_change);
    else
      orphans.push_back(load);
  }
  forward(orphans, add_change);
}

void FixLbmCouple::hold(int i, const protocol::Load& load, bool add_change) {
  if (atom->mask[i] & held_still_) add_change = false;
  for (int k = 0; k < 3; ++k) {
    if (add_change) {
      atom->f[i][k] += load.force[k] - held_[i][k];
      atom->torque[i][k] += load.torque[k] - held_[i][3 + k];
    }
    held_[i][k] = load.force[k];
    held_[i][3 + k] = load.torque[k];
  }
}

/// Brings loads to the ranks that own their particles now.
void FixLbmCouple::forward(std::vector<protocol::Load>& orphans, bool add_change) {
  const int mine = static_cast<int>(orphans.size() * sizeof(protocol::Load));
  std::vector<int> sizes(comm->nprocs), starts(comm->nprocs, 0);
  MPI_Allgather(&mine, 1, MPI_INT, sizes.data(), 1, MPI_INT, world);
  for (int r = 1; r < comm->nprocs; ++r) starts[r] = starts[r - 1] + sizes[r - 1];
  std::vector<protocol::Load> all((starts.back() + sizes.back()) / sizeof(protocol::Load));
  if (all.empty()) return;
  MPI_Allgatherv(orphans.data(), mine, MPI_BYTE, all.data(), sizes.data(), starts.data(), MPI_BYTE,
                 world);
  for (const protocol::Load& load : all) {
    const int i = atom->map(static_cast<int>(load.id));
    if (i >= 0 && i < atom->nlocal) hold(i, load, add_change);
  }
}

// ---- held loads travel with their particles ---------------------------------------------------

void FixLbmCouple::grow_arrays(int n) {
  memory->grow(held_, n, kColumns, "lbm/couple:held");
  array_atom = held_;
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
  buffer[0] = kKept + 1;  // LIGGGHTS' convention: a fix's record begins with its length
  std::copy_n(held_[i], kKept, buffer + 1);
  return kKept + 1;
}
void FixLbmCouple::unpack_restart(int i, int nth) {
  const double* record = atom->extra[i];
  for (int n = 0; n < nth; ++n) record += static_cast<int>(record[0]);
  if (record[0] != kKept + 1)
    fail("the restart file is of another version of this fix; start again without it");
  set_arrays(i);
  std::copy_n(record + 1, kKept, held_[i]);
}
double FixLbmCouple::memory_usage() {
  return static_cast<double>(atom->nmax) * kColumns * sizeof(double);
}

}  // namespace dem
