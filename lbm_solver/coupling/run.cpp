// SPDX-License-Identifier: GPL-2.0-or-later
#include "lbm_solver/coupling/run.h"

#include <algorithm>
#include <cmath>
#include <ctime>
#include <filesystem>
#include <limits>

#include "lbm_solver/base/errors.h"
#include "lbm_solver/coupling/hello.h"
#include "lbm_solver/coupling/lubrication.h"
#include "lbm_solver/io/checkpoint.h"
#include "protocol/program.h"
#include "protocol/solid_parts.h"
#include "protocol/walls.h"

namespace lbm {
namespace {

std::int64_t last_interval(const Plan& plan, const RunOptions& options) {
  if (!options.until) return plan.intervals;
  return std::clamp<std::int64_t>(first_state(*options.until, plan.interval()), 1, plan.intervals);
}

/// The summary of a run that has ended. Collective.
Summary summarise(const Scene& scene, const RunOptions& options, const Fluid& fluid,
                  const Observers& observers, const PartClock& clock, const std::string& ending) {
  Summary summary = observers.summary(clock.total());
  summary.scene = scene.title;
  summary.set = options.set;
  summary.variant = options.variant;
  summary.versions["lbm"] = BPLBM_VERSION;
  summary.ending = ending;
  summary.cpu_seconds = static_cast<double>(std::clock()) / CLOCKS_PER_SEC;
  for (const auto& [part, seconds] : clock.parts())
    summary.time_share[part] = seconds / clock.total();
  for (const auto& [part, bytes] : fluid.bytes()) summary.megabytes[part] = 1e-6 * bytes;
  return summary;
}

/// Grid and steps that a checkpoint belongs to. Of the step, what it was before it was fitted to an
/// end time, which may be another one when the run goes on.
std::vector<double> identity(const Plan& plan) {
  const auto& p = plan.kernel.parameters;
  return {static_cast<double>(plan.domain.nx),
          static_cast<double>(plan.domain.ny),
          static_cast<double>(plan.domain.nz),
          plan.kernel.precision == Precision::Single ? 1.0 : 0.0,
          plan.wished_step,
          p.tau,
          static_cast<double>(plan.fluid_steps),
          static_cast<double>(plan.substeps)};
}

/// Collective; rank 0 writes.
void save(const std::string& path, const Plan& plan, const Decomposition& ranks, State state,
          const Observers& observers, std::int64_t interval) {
  state["observers"] = observers.state();
  if (ranks.rank() != 0) return;
  state["identity"] = identity(plan);
  state["interval"] = {static_cast<double>(interval)};
  state["step"] = {plan.units.dt};
  write_checkpoint(path, state);
}

/// Every rank reads; the populations are for rank 0, which hands them out.
State load(const std::string& path, const Plan& plan, const Decomposition& ranks) {
  State state = read_checkpoint(path);
  if (ranks.rank() != 0) state["populations"].clear();
  if (state["identity"] != identity(plan) || state["interval"].size() != 1)
    throw InputError(path, "was written by a run with another grid or step",
                     "restart with the same scene and overlays");
  return state;
}

std::int64_t checkpoint_intervals(const Scene& scene, const Plan& plan) {
  if (scene.checkpoint_every <= 0.0) return 0;
  const double intervals = std::min(scene.checkpoint_every / plan.interval(), 1e15);
  return std::max<std::int64_t>(1, std::llround(intervals));
}

/// Where a coupled run begins; checks that the solid has its part of the checkpoint.
RunStart start_of(const RunOptions& options, const Plan& plan, const State& state) {
  RunStart start;
  const auto path = [&](const std::string& name) {
    return std::filesystem::absolute(options.out + "/" + name).lexically_normal().string();
  };
  start.checkpoint = path("checkpoint");
  if (options.restart.empty()) return start;
  start.interval = static_cast<std::int64_t>(state.at("interval")[0]);
  if (start.interval >= last_interval(plan, options))
    throw InputError(path(options.restart) + ".h5",
                     "lies at the end of the run: nothing is left to do",
                     "raise --until, or start again without --restart");
  start.solid_part = protocol::SolidParts(path(options.restart)).name(start.interval);
  if (!std::filesystem::is_regular_file(start.solid_part))
    throw InputError(start.solid_part, "is missing: the solid's part of the checkpoint",
                     options.restart == "fault"
                         ? "use --restart alone for the last whole checkpoint"
                         : "start again without --restart");
  return start;
}

/// The coupled time loop. An interval reads: states arrive, the fluid makes its steps, loads leave.
class CoupledRun {
 public:
  CoupledRun(const Scene& scene, const Plan& plan, const Decomposition& ranks,
             protocol::Channel& channel, const RunOptions& options, Log& log)
      : scene_(scene),
        plan_(plan),
        ranks_(ranks),
        options_(options),
        log_(log),
        state_(options.restart.empty()
                   ? State{}
                   : load(options.out + "/" + options.restart + ".h5", plan, ranks)),
        start_(start_of(options, plan, state_)),
        solid_(channel, make_hello(scene, plan, start_, ranks.cells()), scene.coupling->timeout),
        fluid_(make_fluid(scene, plan, ranks)),
        bodies_(obstacle_bodies(scene, plan)),
        obstacles_(bodies_.size()),
        particles_(plan.units, scene, ranks, plan.kernel.solid_term),
        lubrication_{(plan.kernel.parameters.tau - 0.5) / 3.0, scene.coupling->lubrication_range,
                     static_cast<double>(plan.fluid_steps)},
        partner_(solid_.agree()),
        observers_(scene, plan, ranks, options.out, log, start_.interval),
        end_(last_interval(plan, options)),
        every_(checkpoint_intervals(scene, plan)) {
    log.say(start_.interval, "coupling", "agreed with {} {}: {} substeps an interval of {:.6g} s{}",
            partner_.program, partner_.program_version, plan.substeps, plan.interval(),
            scene.coupling->overlapped ? ", overlapped" : "");
    for (const std::string& wall :
         protocol::one_sided_walls(make_hello(scene, plan, start_, ranks.cells()), partner_))
      log.say(start_.interval, "warning", "{}", wall);
    if (options.restart.empty()) return;
    fluid_.restore(state_);
    particles_.restore(state_.at("particles"));
    observers_.restore(state_.at("observers"));
    log.say(start_.interval, "restart", "goes on from {}/{}.h5", options.out, options.restart);
  }

  Summary run() {
    try {
      exchange_until_end();
    } catch (const std::exception& error) {
      keep_last_state(error);
      throw;
    }
    clock_.charge("output");
    Summary summary = summarise(scene_, options_, fluid_, observers_, clock_, ending_);
    summary.versions[partner_.program] = partner_.program_version;
    summary.versions["protocol"] = fmt::format("{}", protocol::kProtocolVersion);
    summary.waiting = clock_.parts().at("waiting");
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
      if (arrival.head.flags & protocol::kCheckpoint) write_checkpoint(interval);
      const bool last = arrival.head.flags & protocol::kLast;
      // a frame may find the disk full: until it is written both still stand at this interval
      if (every_ > 0 && observers_.draws_at(interval))
        memory_ = particles_.memory();
      else
        stands_at_.reset();
      particles_.arrive(arrival.particles, plan_.interval());
      particles_.tell_bonds(arrival.bonds);
      place(0);
      observers_.at_state(interval, fluid_, &particles_, last);
      clock_.charge("output");
      if (last) break;
      stands_at_.reset();
      memory_.reset();
      for (int step = 0; step < plan_.fluid_steps; ++step) advance(step);
      solid_.answer(particles_.mean_loads(plan_.fluid_steps), flags_after(interval));
      stands_at_ = interval + 1;
      clock_.charge("exchange");
      observers_.after_interval(interval, fluid_, &particles_);
      clock_.charge("output");
    }
  }

  /// Where the solids are when a step of the interval begins.
  void place(int step) {
    bodies_.resize(obstacles_);
    const auto moving = particles_.bodies(step * plan_.units.dt);
    bodies_.insert(bodies_.end(), moving.begin(), moving.end());
    fluid_.place(bodies_);
    clock_.charge("placing");
  }

  void advance(int step) {
    if (step > 0) place(step);
    fluid_.step();
    clock_.charge("sweep");
    std::vector<BodyLoad> loads = fluid_.loads();
    if (lubrication_.range > 0.0) {
      masses_.resize(obstacles_, std::numeric_limits<double>::infinity());
      const std::vector<double> moving_masses = particles_.masses();
      masses_.insert(masses_.end(), moving_masses.begin(), moving_masses.end());
      lubrication_.add(bodies_, masses_, plan_.domain, ranks_.cells(), loads);
    }
    const std::span<const BodyLoad> all(loads);
    if (obstacles_ > 0) observers_.add_loads(all.first(obstacles_));
    particles_.add(all.subspan(obstacles_));
    clock_.charge("loads");
  }

  /// What the solid is told with the loads of an interval.
  std::uint32_t flags_after(std::int64_t interval) {
    const bool stop = interval + 1 >= end_ || protocol::signalled();
    std::uint32_t flags = stop ? protocol::kStop : protocol::kContinue;
    if (stop || observers_.draws_at(interval + 1)) flags |= protocol::kWantBonds;
    if (every_ > 0 && (protocol::signalled() || (interval + 1) % every_ == 0))
      flags |= protocol::kCheckpoint;
    if (protocol::signalled())
      ending_ = fmt::format("stopped by a signal{}",
                            every_ > 0 ? "; --restart goes on from its checkpoint" : "");
    return flags;
  }

  /// The solid's part lies on disk; with the fluid's both are complete.
  void write_checkpoint(std::int64_t interval) { write_state("checkpoint", interval); }

  void write_state(const std::string& name, std::int64_t interval) {
    State state = fluid_.state();
    state["particles"] = memory_ ? *memory_ : particles_.memory();
    save(options_.out + "/" + name + ".h5", plan_, ranks_, std::move(state), observers_, interval);
    clock_.charge("checkpoint");
  }

  /// At a fault, where the scene has checkpoints: the fluid's part of one, beside the last whole
  /// one, if the fluid stands between two intervals and is finite. The solid keeps its part where
  /// it can, and where both stood at one interval, --restart=fault goes on from there.
  void keep_last_state(const std::exception& error) {
    const bool everywhere = ranks_.alone() || dynamic_cast<const NumericsError*>(&error) ||
                            dynamic_cast<const protocol::PeerFault*>(&error);
    if (every_ == 0 || !stands_at_ || !everywhere) return;
    const protocol::Deadline deadline(error, "lbm");
    try {
      if (!fluid_.extremes().finite) return;
      write_state("fault", *stands_at_);
      log_.say(*stands_at_, "fault", "the fluid's last state is kept in {}/fault.h5", options_.out);
    } catch (const std::exception& second) {
      log_.say(*stands_at_, "fault", "the fluid's last state is not kept: {}", second.what());
    }
  }

  const Scene& scene_;
  const Plan& plan_;
  const Decomposition& ranks_;
  const RunOptions& options_;
  Log& log_;
  const State state_;  // of the checkpoint that it goes on from
  const RunStart start_;
  protocol::FluidSession solid_;
  Fluid fluid_;
  std::vector<Body> bodies_;  // obstacles first, then the particles
  const std::size_t obstacles_;
  Particles particles_;
  const Lubrication lubrication_;
  std::vector<double> masses_;
  const protocol::Hello& partner_;
  Observers observers_;
  const std::int64_t end_, every_;
  std::optional<std::int64_t> stands_at_ = start_.interval;  // no part of an interval is done
  std::optional<std::vector<double>> memory_;  // of particles_ before those of stands_at_ arrived
  std::string ending_ = "complete";
  PartClock clock_;
};

}  // namespace

std::optional<double> step_to_keep(const Scene& scene, const RunOptions& options) {
  if (options.restart.empty()) return std::nullopt;
  if (options.restart == "fault" && !scene.coupling)
    throw InputError(options.out + "/fault.h5", "is kept by coupled runs only",
                     "use --restart for the last checkpoint");
  const std::string path = options.out + "/" + options.restart + ".h5";
  const std::vector<double> step = read_checkpoint_array(path, "step");
  if (step.size() == 1 && std::isfinite(step[0]) && step[0] > 0.0) return step[0];
  throw InputError(path, "holds no time step: it is damaged, or of an earlier version",
                   "start again without --restart");
}

void check_until(const Scene& scene, const RunOptions& options) {
  if (!options.until) return;
  const double until = *options.until;
  if (std::isfinite(until) && until > 0.0 && until <= scene.end_time * (1.0 + 1e-9)) return;
  throw InputError(fmt::format("--until = {} s", until),
                   fmt::format("is no time of the scene, which ends at {} s", scene.end_time),
                   "give a time above 0 and up to its end, or raise run.end_time");
}

Summary run_coupled(const Scene& scene, const Plan& plan, const Decomposition& ranks,
                    protocol::Channel& channel, const RunOptions& options, Log& log) {
  return CoupledRun(scene, plan, ranks, channel, options, log).run();
}

Summary run_alone(const Scene& scene, const Plan& plan, const Decomposition& ranks,
                  const RunOptions& options, Log& log) {
  const std::string checkpoint = options.out + "/checkpoint.h5";
  Fluid fluid = make_fluid(scene, plan, ranks);
  State state;
  if (!options.restart.empty()) {
    state = load(checkpoint, plan, ranks);
    fluid.restore(state);
  }
  const bool loads = !obstacle_bodies(scene, plan).empty();
  Observers observers(scene, plan, ranks, options.out, log, fluid.steps());
  if (!options.restart.empty()) {
    observers.restore(state["observers"]);
    log.say(fluid.steps(), "restart", "goes on from {}", checkpoint);
  }
  const std::int64_t end = last_interval(plan, options);
  const std::int64_t every = checkpoint_intervals(scene, plan);
  std::string ending = "complete";
  PartClock clock;
  const std::int64_t first = fluid.steps();
  for (std::int64_t step = first;; step = fluid.steps()) {
    const bool signalled = ranks.max(protocol::signalled() ? 1.0 : 0.0) > 0.0;
    if (signalled)
      ending = "stopped by a signal";
    else if (observers.steady())
      ending = fmt::format("steady: the velocity changes by less than {} a turnover",
                           scene.steady_below);
    const bool last = step >= end || signalled || observers.steady();
    if (every > 0 && step > first && (step % every == 0 || signalled))
      save(checkpoint, plan, ranks, fluid.state(), observers, step);
    observers.at_state(step, fluid, nullptr, last);
    clock.charge("output");
    if (last) break;
    std::int64_t next = std::min(observers.next_look(step), end);
    if (every > 0) next = std::min(next, (step / every + 1) * every);
    fluid.advance(next - step);
    clock.charge("sweep");
    if (loads) observers.add_loads(fluid.loads());
    clock.charge("loads");
    observers.after_interval(next - 1, fluid, nullptr);
    clock.charge("output");
  }
  const Summary summary = summarise(scene, options, fluid, observers, clock, ending);
  if (ranks.rank() == 0) write_summary(options.out, summary);
  return summary;
}

}  // namespace lbm
