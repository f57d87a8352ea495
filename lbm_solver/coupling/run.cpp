// SPDX-License-Identifier: GPL-2.0-or-later
#include "lbm_solver/coupling/run.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <utility>

#include "lbm_solver/base/errors.h"
#include "lbm_solver/coupling/block_balance.h"
#include "lbm_solver/coupling/handshake.h"
#include "lbm_solver/coupling/lubrication.h"
#include "lbm_solver/coupling/particle_relay.h"
#include "lbm_solver/coupling/run_state.h"
#include "lbm_solver/coupling/start_check.h"
#include "lbm_solver/coupling/stop_times.h"
#include "lbm_solver/field/moved_record.h"
#include "lbm_solver/io/checkpoint.h"
#include "lbm_solver/io/script_variables.h"
#include "protocol/program/program.h"
#include "protocol/program/solid_parts.h"
#include "protocol/wire/walls.h"

namespace lbm {
namespace {

/// Where a coupled run begins, and where its checkpoints lie.
RunStart start_of(const RunOptions& options, const Plan& plan, const Restart* restart) {
  const auto absolute = [](const std::string& path) {
    return std::filesystem::absolute(path).lexically_normal().string();
  };
  RunStart start;
  start.out = options.out;
  start.checkpoint = absolute(options.out + "/checkpoint");
  if (const std::string problem = why_no_script_path(start.checkpoint); !problem.empty())
    throw InputError("--out " + options.out, problem, "choose another folder");
  if (!restart) return start;
  start.interval = restart->interval;
  if (start.interval >= last_interval(plan, options))
    throw InputError(absolute(restart->path), "lies at the end of the run: nothing is left to do",
                     "raise --until, or start again without --restart");
  start.solid_part = absolute(restart->solid_part);
  return start;
}

/// The coupled time loop. An interval reads: states arrive, the fluid makes its steps, loads leave.
class CoupledRun {
 public:
  CoupledRun(const Scene& scene, const Plan& plan, const Decomposition& ranks,
             protocol::Channel& channel, const RunOptions& options, Log& log,
             const Restart* restart)
      : scene_(scene),
        plan_(plan),
        ranks_(ranks),
        options_(options),
        log_(log),
        start_(start_of(options, plan, restart)),
        solid_(channel, make_handshake(scene, plan, start_, ranks.cells()),
               scene.coupling->timeout),
        relay_(make_handshake(scene, plan, start_), plan.units, ranks),
        balance_(scene, plan, ranks),
        fluid_(make_fluid(scene, plan, ranks)),
        bodies_(obstacle_bodies(scene, plan)),
        obstacles_(bodies_.size()),
        particles_(plan.units, scene, ranks, plan.kernel.solid_term),
        lubrication_{(plan.kernel.parameters.tau - 0.5) / 3.0, scene.coupling->lubrication_range,
                     static_cast<double>(plan.fluid_steps)},
        partner_(solid_.agree()),
        observers_(scene, plan, ranks, options.out, log, start_.interval),
        end_(last_interval(plan, options)),
        times_(scene, plan),
        keep_last_(!restart || !restart->earlier) {
    observers_.ends_at(end_);
    log.say(start_.interval, "coupling", "agreed with {} {}: {} substeps an interval of {:.6g} s{}",
            partner_.program, partner_.program_version, plan.substeps, plan.interval(),
            scene.coupling->overlapped ? ", overlapped" : "");
    for (const std::string& wall :
         protocol::one_sided_walls(make_handshake(scene, plan, start_, ranks.cells()), partner_))
      log.say(start_.interval, "warning", "{}", wall);
    if (!partner_.sides)
      log.say(start_.interval, "coupling",
              "{} does not tell its walls: they are not compared with the fluid's",
              partner_.program);
    if (!restart) return;
    load_from(*restart, [&] {
      load(restart->record);
      saved_particles_ = restart->record.part("particles");
    });
    say_restart(*restart, log);
  }

  Summary run() {
    try {
      exchange_until_end();
    } catch (const std::exception& error) {
      keep_last_state(error);
      throw;
    }
    clock_.charge("output");
    Summary summary = summarise(scene_, options_, *fluid_, observers_, clock_,
                                waited_ + fluid_->waited(), ending_);
    summary.versions[partner_.program] = partner_.program_version;
    summary.versions["protocol"] = fmt::format("{}", protocol::kProtocolVersion);
    summary.waiting = clock_.parts().at("waiting");
    summary.overlapped = scene_.coupling->overlapped;
    if (particles_.report()) summary.solid = *particles_.report();
    summary.block_moves = balance_.moves();
    say_busiest(scene_, *fluid_, summary, log_);
    if (ranks_.rank() == 0) write_summary(options_.out, summary);
    return summary;
  }

 private:
  void exchange_until_end() {
    for (std::int64_t interval = start_.interval;; ++interval) {
      const protocol::Arrival& arrival = solid_.receive();
      clock_.charge("waiting");
      if (arrival.goodbye) {
        ending_ = "stopped by solid: " + *arrival.goodbye;
        break;
      }
      if (arrival.head.flags & protocol::kCheckpoint) complete_checkpoint(interval);
      stop_wished_ = arrival.head.flags & protocol::kStopWished;
      const bool last = arrival.head.flags & protocol::kLast;
      // a frame may find the disk full: until it is written both still stand at this interval
      if (!times_.any() || !observers_.draws_at(interval))
        resumable_interval_.reset();
      else if (!saved_particles_)
        saved_particles_ = particles_.save();
      particles_.arrive(relay_.arrive(arrival.particles), plan_.interval());
      particles_.tell(arrival.report);
      if (particles_.has_clumps()) expect_takes_clumps(plan_.scheme);
      if (scene_.coupling->carry_weight) carry_weight(interval);
      if (interval == 0) {
        warn_of_count(partner_.particles, ranks_, particles_, log_);
        observers_.remember(warn_of_starts(scene_, plan_, *fluid_, particles_, log_));
      }
      place(0);
      observers_.at_state(interval, *fluid_, &particles_, last);
      clock_.charge("output");
      if (last) break;
      resumable_interval_.reset();
      saved_particles_.reset();
      for (int step = 0; step < plan_.fluid_steps; ++step) advance(step);
      solid_.answer(relay_.give_back(particles_.mean_loads(plan_.fluid_steps)),
                    flags_after(interval));
      resumable_interval_ = interval + 1;
      clock_.charge("exchange");
      observers_.after_interval(interval, *fluid_, &particles_);
      clock_.charge("output");
      balance_blocks(interval + 1);
    }
  }

  void load(const Record& record) {
    fluid_->load(record.part("fluid"));
    particles_.load(record.part("particles"));
    observers_.load(record.part("observers"));
  }

  /// Between two intervals, while the solid makes its steps.
  void balance_blocks(std::int64_t interval) {
    if (interval >= end_ || !balance_.due(interval)) return;
    const double worked = work_seconds(clock_, waited_ + fluid_->waited());
    const std::optional<Decomposition> to = balance_.look(worked, *fluid_);
    if (to) move_to(*to);
    const double seconds = clock_.charge("balance");
    if (to) log_.say(interval, "ranks", "{}", balance_.moved(seconds, ranks_));
  }

  /// Goes on with other blocks as from a checkpoint on other ranks, but in memory: at no time is
  /// more there than the cells in two places.
  void move_to(const Decomposition& to) {
    const auto stands_at = std::exchange(resumable_interval_, std::nullopt);
    Record record;
    record.set("fluid", fluid_->save());
    record.set("particles", particles_.save());
    record.set("observers", observers_.save());
    record = moved(record, ranks_, to);
    waited_ += fluid_->waited();
    observers_.move_to(to);
    fluid_.reset();
    ranks_ = to;
    relay_.move_to(to);
    fluid_.emplace(make_fluid(scene_, plan_, to));
    particles_ = Particles(plan_.units, scene_, to, plan_.kernel.solid_term);
    load(record);
    saved_particles_ = record.part("particles");  // until the next ones arrive
    force_is_set_ = false;
    resumable_interval_ = stands_at;
  }

  /// The solid has written its part of a checkpoint.
  void complete_checkpoint(std::int64_t interval) {
    if (!checkpoint_asked_)
      throw protocol::ProtocolError(
          fmt::format("interval {}: {} says that it has written a checkpoint, for which nobody had "
                      "asked (flag 4 of the loads)",
                      interval, partner_.program));
    write_checkpoint(interval);
  }

  /// The force on the fluid that carries the particles' weight, anew where their number changes.
  void carry_weight(std::int64_t interval) {
    Vec3 weight = particles_.weight_in_fluid();
    ranks_.sum(std::span<double>(weight.data(), 3));
    if (weight == carried_ && force_is_set_) return;
    const bool news = (weight - carried_).norm() > 1e-12 * weight.norm();  // beyond round-off
    carried_ = weight;
    force_is_set_ = true;
    const Cell3 n = plan_.domain.cells();
    const double mass = plan_.units.mass() * n[0] * n[1] * n[2];  // of fluid that filled the box
    const Vec3 force = scene_.fluid.body_force - weight / mass;
    fluid_->set_body_force(force * (plan_.units.dt * plan_.units.dt / plan_.units.dx));
    if (!news) return;
    log_.say(interval, "balance",
             "a body force of ({:.6g}, {:.6g}, {:.6g}) m/s² on the fluid, with "
             "which the particles' weight is carried",
             force.x(), force.y(), force.z());
  }

  /// Where the solids are when a step of the interval begins.
  void place(int step) {
    bodies_.resize(obstacles_);
    if (moving_) bodies_ = obstacle_bodies(scene_, plan_, fluid_->steps());
    const auto moving = particles_.bodies(step * plan_.units.dt);
    bodies_.insert(bodies_.end(), moving.begin(), moving.end());
    fluid_->place(bodies_);
    clock_.charge("placing");
  }

  void advance(int step) {
    if (step > 0) place(step);
    fluid_->step();
    clock_.charge("sweep");
    std::vector<BodyLoad> loads = fluid_->loads();
    if (lubrication_.range > 0.0) {
      masses_.resize(obstacles_, std::numeric_limits<double>::infinity());
      const std::vector<double> moving_masses = particles_.masses();
      masses_.insert(masses_.end(), moving_masses.begin(), moving_masses.end());
      lubrication_.add(bodies_, masses_, plan_.domain, ranks_.cells(), loads);
    }
    const std::span<const BodyLoad> all(loads);
    observers_.add_loads(*fluid_, all.first(obstacles_));
    particles_.add(all.subspan(obstacles_));
    clock_.charge("loads");
  }

  /// What the solid is told with the loads of an interval.
  std::uint32_t flags_after(std::int64_t interval) {
    const std::int64_t next = interval + 1;
    const bool signalled = (protocol::signalled() || stop_wished_) && times_.stop(next);
    const bool stop = next >= end_ || signalled;
    std::uint32_t flags = stop ? protocol::kStop : protocol::kContinue;
    if (stop || observers_.draws_at(next)) flags |= protocol::kWantBonds;
    if (times_.any() && times_.stop(next)) flags |= protocol::kSettle;
    if (times_.any() && (signalled || times_.checkpoint(next))) flags |= protocol::kCheckpoint;
    checkpoint_asked_ = flags & protocol::kCheckpoint;
    if (signalled)
      ending_ = fmt::format("stopped by a signal{}",
                            times_.any() ? "; --restart goes on from its checkpoint" : "");
    return flags;
  }

  /// The solid's part lies on disk; with the fluid's both are complete.
  void write_checkpoint(std::int64_t interval) {
    const std::string before = fluid_part_before(options_.out, "checkpoint");
    // what was found damaged at the start does not take the place of the good one before it
    write_state("checkpoint", interval, keep_last_ ? before : "");
    keep_last_ = true;
  }

  void write_state(const std::string& name, std::int64_t interval, const std::string& before) {
    const bool coupled = name == "checkpoint";  // at a fault, the other may not have its part yet
    const protocol::SolidParts parts(options_.out + "/" + name);
    Record record = state_record(scene_, plan_, *fluid_, observers_, interval,
                                 coupled ? parts.name(interval) : "");
    record.set("particles", saved_particles_ ? *saved_particles_ : particles_.save());
    lbm::write_checkpoint(fluid_part(options_.out, name), record, interval, before, &ranks_);
    clock_.charge("checkpoint");
  }

  /// At a fault, where the scene has checkpoints: the fluid's part of one, beside the last whole
  /// one, if the fluid stands between two intervals and is finite. The solid keeps its part where
  /// it can, and where both stood at one interval, --restart=fault goes on from there.
  void keep_last_state(const std::exception& error) {
    const bool everywhere = ranks_.alone() || dynamic_cast<const NumericsError*>(&error) ||
                            dynamic_cast<const protocol::PeerFault*>(&error);
    if (!times_.any() || !resumable_interval_ || !everywhere) return;
    const protocol::Deadline deadline(error, "lbm");
    try {
      if (!fluid_->extremes().finite) return;
      write_state("fault", *resumable_interval_, "");
      log_.say(*resumable_interval_, "fault", "the fluid's last state is kept in {}/fault.h5",
               options_.out);
    } catch (const std::exception& second) {
      log_.say(*resumable_interval_, "fault", "the fluid's last state is not kept: {}",
               second.what());
    }
  }

  const Scene& scene_;
  const Plan& plan_;
  Decomposition ranks_;
  const RunOptions& options_;
  Log& log_;
  const RunStart start_;
  protocol::FluidSession solid_;
  ParticleRelay relay_;
  BlockBalance balance_;
  std::optional<Fluid> fluid_;  // of the present blocks
  double waited_ = 0.0;         // for neighbours, in the blocks before [s]
  std::vector<Body> bodies_;    // obstacles first, then the particles
  const std::size_t obstacles_;
  const bool moving_ = has_moving_bodies(scene_);  // any of the obstacles
  Particles particles_;
  const Lubrication lubrication_;
  std::vector<double> masses_;
  const protocol::Hello& partner_;
  Observers observers_;
  const std::int64_t end_;
  const StopTimes times_;
  bool stop_wished_ = false;  // the solid was told to end
  bool checkpoint_asked_ = false;
  bool keep_last_;  // the fluid's part that lies there is good
  std::optional<std::int64_t> resumable_interval_ =
      start_.interval;           // no part of an interval is done
  Vec3 carried_ = Vec3::Zero();  // weight of the particles in the fluid [N]
  bool force_is_set_ = true;     // that carries it
  std::optional<Record>
      saved_particles_;  // of particles_ before those of resumable_interval_ arrived
  std::string ending_ = "complete";
  PartClock clock_;
};

}  // namespace

void check_until(const Scene& scene, const RunOptions& options) {
  if (!options.until) return;
  const double until = *options.until;
  if (std::isfinite(until) && until > 0.0 && until <= scene.end_time * (1.0 + 1e-9)) return;
  throw InputError(fmt::format("--until = {} s", until),
                   fmt::format("is no time of the scene, which ends at {} s", scene.end_time),
                   "give a time above 0 and up to its end, or raise run.end_time");
}

Summary run_coupled(const Scene& scene, const Plan& plan, const Decomposition& ranks,
                    protocol::Channel& channel, const RunOptions& options, Log& log,
                    const Restart* restart) {
  if (ranks.rank() == 0) write_meshes(scene, options.out);  // before the solid is told their names
  return CoupledRun(scene, plan, ranks, channel, options, log, restart).run();
}

}  // namespace lbm
