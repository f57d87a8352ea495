// SPDX-License-Identifier: MIT
#include "protocol/solid/particle_coupling.h"

#include <cmath>
#include <utility>

#include "protocol/program/program.h"
#include "protocol/wire/clumps.h"

namespace protocol {

std::vector<Ball> balls_of(const EngineParticles& p, int group) {
  std::vector<Ball> balls;
  for (int i = 0; i < p.count; ++i) {
    const double* x = p.x[i];
    const bool usable = std::isfinite(x[0] + x[1] + x[2]) && p.radius[i] > 0.0;
    if (!(p.mask[i] & group) || !usable) continue;
    balls.push_back({p.id[i], {x[0], x[1], x[2]}, p.radius[i]});
    if (p.carrier) balls.back().carrier = p.carrier[i];
  }
  return balls;
}

void ParticleCoupling::begin(const Hello& mine) {
  const Hello& fluid = session_.fluid();
  interval_ = fluid.first_interval;
  overlapped_ = fluid.schedule == Schedule::Overlapped;
  parts_ = SolidParts::of(fluid);
  session_.agree(mine);
  progress_.agreed = begun_ = true;
  first_step_ = engine_.step_number();
  send_states();
  // The first interval is serial in either schedule, unless a checkpoint has the loads to begin
  // with.
  if (!overlapped_ || interval_ == 0) take_loads(false);
}

void ParticleCoupling::resume() {
  const bool write = std::exchange(checkpoint_asked_, false);
  if (write) {
    engine_.write_part(*parts_, interval_);
    MPI_Barrier(engine_.communicator());  // it is there before any rank says so
  }
  send_states(write ? kCheckpoint : kContinue);
  if (!overlapped_ && !progress_.over) take_loads(false);
}

void ParticleCoupling::end_step() {
  if (progress_.over || (engine_.step_number() - first_step_) % substeps_ != 0) return;
  ++interval_;
  if (underway_) take_loads(true);  // overlapped: of the interval that ends, for the next one
  if (settle_asked_ || checkpoint_asked_) {
    setting_up_again_ = true;
    settle_asked_ = false;
    engine_.set_up_again();
    setting_up_again_ = false;
    return;
  }
  send_states();
  if (!overlapped_ && !progress_.over) take_loads(true);
}

namespace {

/// A sphere of a clump.
bool is_part(const EngineParticles& p, int i) {
  return p.carrier && p.carrier[i] != kItself;
}

}  // namespace

void ParticleCoupling::add_loads(Moment when) {
  const EngineParticles p = engine_.particles();
  if (any_clumps_) engine_.push_clumps(clumps_.loads(), when);
  for (int i = 0; i < p.count; ++i) {
    if (!(p.mask[i] & p.group) || is_part(p, i)) continue;
    for (int k = 0; k < 3; ++k) {
      p.force[i][k] += p.held[i][kHeldForce + k];
      p.torque[i][k] += p.held[i][kHeldTorque + k];
    }
  }
}

void ParticleCoupling::gather(const EngineParticles& p) {
  states_.clear();
  shapes_.clear();
  local_.clear();
  const double factor = p.dimension == 2 ? 0.5 : 0.4;  // inertia of a disc, of a sphere
  for (int i = 0; i < p.count; ++i) {
    if (!(p.mask[i] & p.group) || is_part(p, i)) continue;
    const double *x = p.x[i], *v = p.v[i], *w = p.omega[i];
    const double r = p.radius[i], m = p.mass[i];
    states_.push_back({p.id[i], {x[0], x[1], x[2]}, {v[0], v[1], v[2]}, {w[0], w[1], w[2]}});
    if (p.held[i][kHeldId] != static_cast<double>(p.id[i])) {  // the id has come to this particle
      p.held[i][kHeldId] = static_cast<double>(p.id[i]);
      p.held[i][kHeldEpoch] = static_cast<double>(interval_);
    }
    shapes_.push_back({p.id[i], r, m, factor * m * r * r, p.type[i],
                       static_cast<std::int64_t>(p.held[i][kHeldEpoch])});
    local_.push_back(i);
  }
  gather_clumps(p);
}

/// All ranks together, where any of them has a clump.
void ParticleCoupling::gather_clumps(const EngineParticles& p) {
  const std::vector<EngineClump> mine = engine_.clumps();
  int any = mine.empty() ? 0 : 1;
  const MPI_Comm comm = engine_.communicator();
  MPI_Allreduce(MPI_IN_PLACE, &any, 1, MPI_INT, MPI_MAX, comm);
  any_clumps_ = any != 0;
  if (!any_clumps_) return;
  std::vector<EngineSphere> spheres;
  for (int i = 0; i < p.count; ++i) {
    if (!(p.mask[i] & p.group) || !is_part(p, i)) continue;
    const double *x = p.x[i], *v = p.v[i], *w = p.omega[i];
    spheres.push_back({p.id[i],
                       p.carrier[i],
                       p.type[i],
                       p.radius[i],
                       {x[0], x[1], x[2]},
                       {v[0], v[1], v[2]},
                       {w[0], w[1], w[2]}});
  }
  const Setting now = engine_.setting();
  Hello box = session_.fluid();
  box.box_lo = now.box_lo;
  box.box_hi = now.box_hi;
  clumps_.gather(comm, box, mine, spheres, {states_, shapes_});
  for (std::size_t n = local_.size(); n < shapes_.size(); ++n)
    local_.push_back(is_part(shapes_[n]) ? kPart : kClump);
}

void ParticleCoupling::send_states(std::uint32_t flags) {
  const Setting now = engine_.setting();
  gather(engine_.particles());
  const double interval = now.step * substeps_;
  if (stop_asked_) flags |= kLast;
  if (signalled()) flags |= kStopWished;
  session_.set(now);
  session_.send({interval_, static_cast<double>(interval_) * interval, flags}, states_, shapes_,
                engine_.report());
  progress_.over = stop_asked_;
  underway_ = !stop_asked_;
  if (progress_.over) engine_.note_end();
}

namespace {

/// @param add_change  the forces of the step just done are still there and will act in the next
///                    first half-step: replace the old load by the new one there too, so that the
///                    impulse of an interval is its load times its length (not in particles whose
///                    forces a later fix has set: those would creep)
void hold(const EngineParticles& p, int i, const Load& load, bool add_change) {
  if (p.mask[i] & p.frozen) add_change = false;
  double *force = p.held[i] + kHeldForce, *torque = p.held[i] + kHeldTorque;
  for (int k = 0; k < 3; ++k) {
    if (add_change) {
      p.force[i][k] += load.force[k] - force[k];
      p.torque[i][k] += load.torque[k] - torque[k];
    }
    force[k] = load.force[k];
    torque[k] = load.torque[k];
  }
}

}  // namespace

void ParticleCoupling::take_loads(bool add_change) {
  SolidSession::Reply reply;
  try {
    reply = session_.collect();
  } catch (const std::exception& error) {
    engine_.note_failure(error);
    throw;
  }
  underway_ = false;
  stop_asked_ = reply.flags & kStop;
  settle_asked_ = reply.flags & kSettle;
  checkpoint_asked_ = reply.flags & kCheckpoint;
  engine_.note_wishes(reply.flags);
  const EngineParticles p = engine_.particles();
  if (any_clumps_) take_clump_loads(reply.loads, add_change);
  if (!overlapped_) {
    for (std::size_t n = 0; n < local_.size(); ++n)
      if (local_[n] >= 0) hold(p, local_[n], reply.loads[n], add_change);
    return;
  }
  std::vector<Load> orphans;  // of particles that have left this rank since
  for (std::size_t n = 0; n < local_.size(); ++n) {
    if (local_[n] < 0) continue;
    const Load& load = reply.loads[n];
    const int i = engine_.index_of(load.id);
    if (i >= 0 && i < p.count)
      hold(p, i, load, add_change);
    else
      orphans.push_back(load);
  }
  forward(p, orphans, add_change);
}

/// All ranks together.
void ParticleCoupling::take_clump_loads(std::span<const Load> loads, bool add_change) {
  std::vector<Load> mine;
  for (std::size_t n = 0; n < local_.size(); ++n)
    if (local_[n] == kClump) mine.push_back(loads[n]);
  const std::vector<Load> changes = clumps_.take(engine_.communicator(), mine);
  if (add_change) engine_.push_clumps(changes, Moment::End);
}

/// Brings loads to the ranks that own their particles now.
void ParticleCoupling::forward(const EngineParticles& p, std::vector<Load>& orphans,
                               bool add_change) {
  const MPI_Comm comm = engine_.communicator();
  int ranks = 0;
  MPI_Comm_size(comm, &ranks);
  const int mine = static_cast<int>(orphans.size() * sizeof(Load));
  std::vector<int> sizes(ranks), starts(ranks, 0);
  MPI_Allgather(&mine, 1, MPI_INT, sizes.data(), 1, MPI_INT, comm);
  for (int r = 1; r < ranks; ++r) starts[r] = starts[r - 1] + sizes[r - 1];
  std::vector<Load> all((starts.back() + sizes.back()) / sizeof(Load));
  if (all.empty()) return;
  MPI_Allgatherv(orphans.data(), mine, MPI_BYTE, all.data(), sizes.data(), starts.data(), MPI_BYTE,
                 comm);
  for (const Load& load : all) {
    const int i = engine_.index_of(load.id);
    if (i >= 0 && i < p.count) hold(p, i, load, add_change);
  }
}

}  // namespace protocol
