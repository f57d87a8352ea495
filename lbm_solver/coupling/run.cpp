// SPDX-License-Identifier: GPL-2.0-or-later
#include "lbm_solver/coupling/run.h"

#include <cmath>
#include <ctime>
#include <limits>

#include "lbm_solver/base/errors.h"
#include "lbm_solver/coupling/lubrication.h"
#include "lbm_solver/io/checkpoint.h"
#include "protocol/program.h"

namespace lbm {
namespace {

std::int64_t last_interval(const Plan& plan, const RunOptions& options) {
  if (!options.until) return plan.intervals;
  const double intervals = std::ceil(*options.until / plan.interval() - 1e-9);
  return std::min(plan.intervals, std::max<std::int64_t>(1, static_cast<std::int64_t>(intervals)));
}

/// The summary of a run that has ended.
Summary summarise(const Scene& scene, const RunOptions& options, const Observers& observers,
                  const PartClock& clock, const std::string& ending) {
  Summary summary = observers.summary(clock.total());
  summary.scene = scene.title;
  summary.set = options.set;
  summary.variant = options.variant;
  summary.versions["lbm"] = BPLBM_VERSION;
  summary.ending = ending;
  summary.cpu_seconds = static_cast<double>(std::clock()) / CLOCKS_PER_SEC;
  for (const auto& [part, seconds] : clock.parts())
    summary.time_share[part] = seconds / clock.total();
  return summary;
}

}  // namespace

Summary run_coupled(const Scene& scene, const Plan& plan, protocol::Channel& channel,
                    const RunOptions& options, Log& log) {
  protocol::FluidSession solid(channel, make_hello(scene, plan), scene.coupling->timeout);
  Fluid fluid = make_fluid(scene, plan);
  std::vector<Disc> discs = obstacle_discs(scene, plan);  // obstacles first, then the particles
  const std::size_t obstacles = discs.size();
  Particles particles(plan.units, scene);
  const Lubrication lubrication{(plan.kernel.parameters.tau - 0.5) / 3.0,
                                scene.coupling->lubrication_range,
                                static_cast<double>(plan.fluid_steps)};
  std::vector<double> masses;
  const protocol::Hello& partner = solid.agree();
  log.say(0, "coupling", "agreed with {} {}: {} substeps an interval of {:.6g} s", partner.program,
          partner.program_version, plan.substeps, plan.interval());

  Observers observers(scene, plan, options.out, log);
  const std::int64_t end = last_interval(plan, options);
  std::string ending = "complete";
  PartClock clock;
  for (std::int64_t interval = 0;; ++interval) {
    const protocol::Arrival& arrival = solid.receive();
    clock.charge("waiting");
    if (arrival.goodbye) {
      ending = "stopped by solid: " + *arrival.goodbye;
      break;
    }
    particles.arrive(arrival.particles, plan.interval());
    particles.tell_bonds(arrival.bonds);
    if (arrival.head.flags & protocol::kLast) {
      observers.at_end(interval, fluid, &particles);
      break;
    }
    for (int step = 0; step < plan.fluid_steps; ++step) {
      discs.resize(obstacles);
      const auto moving = particles.discs(step * plan.units.dt);
      discs.insert(discs.end(), moving.begin(), moving.end());
      fluid.place(discs);
      clock.charge("placing");
      fluid.step();
      clock.charge("sweep");
      std::vector<DiscLoad> loads = fluid.loads();
      if (lubrication.range > 0.0) {
        masses.resize(obstacles, std::numeric_limits<double>::infinity());
        const std::vector<double> moving_masses = particles.masses();
        masses.insert(masses.end(), moving_masses.begin(), moving_masses.end());
        lubrication.add(discs, masses, plan.domain, loads);
      }
      const std::span<const DiscLoad> all(loads);
      if (obstacles > 0) observers.add_loads(all.first(obstacles));
      particles.add(all.subspan(obstacles));
      clock.charge("loads");
    }
    std::uint32_t flags = interval + 1 >= end ? protocol::kStop : protocol::kContinue;
    if (interval + 1 >= end || observers.draws_at(interval + 1)) flags |= protocol::kWantBonds;
    solid.answer(particles.mean_loads(plan.fluid_steps), flags);
    clock.charge("exchange");
    observers.after_interval(interval, fluid, &particles);
    clock.charge("output");
  }
  clock.charge("output");

  Summary summary = summarise(scene, options, observers, clock, ending);
  summary.versions[partner.program] = partner.program_version;
  summary.versions["protocol"] = fmt::format("{}", protocol::kProtocolVersion);
  summary.waiting = clock.parts().at("waiting");
  write_summary(options.out, summary);
  return summary;
}

namespace {

/// Grid and steps that a checkpoint belongs to.
std::vector<double> identity(const Plan& plan) {
  const auto& p = plan.kernel.parameters;
  return {static_cast<double>(plan.domain.nx), static_cast<double>(plan.domain.ny), plan.units.dt,
          p.tau};
}

void save(const std::string& path, const Plan& plan, const Fluid& fluid,
          const Observers& observers) {
  State state = fluid.state();
  state["observers"] = observers.state();
  state["identity"] = identity(plan);
  write_checkpoint(path, state);
}

State load(const std::string& path, const Plan& plan) {
  State state = read_checkpoint(path);
  if (state["identity"] != identity(plan))
    throw InputError(path, "was written by a run with another grid or step",
                     "restart with the same scene and overlays");
  return state;
}

}  // namespace

Summary run_alone(const Scene& scene, const Plan& plan, const RunOptions& options, Log& log) {
  const std::string checkpoint = options.out + "/checkpoint.h5";
  Fluid fluid = make_fluid(scene, plan);
  State state;
  if (options.restart) {
    state = load(checkpoint, plan);
    fluid.restore(state);
  }
  const bool loads = !obstacle_discs(scene, plan).empty();
  Observers observers(scene, plan, options.out, log, fluid.steps());
  if (options.restart) {
    observers.restore(state["observers"]);
    log.say(fluid.steps(), "restart", "goes on from {}", checkpoint);
  }
  const std::int64_t end = last_interval(plan, options);
  const std::int64_t every = static_cast<std::int64_t>(scene.checkpoint_every / plan.interval());
  std::string ending = "complete";
  PartClock clock;
  std::int64_t step = fluid.steps();
  while (step < end) {
    std::int64_t next = std::min(observers.next_look(step) + 1, end);
    if (every > 0) next = std::min(next, (step / every + 1) * every);
    fluid.advance(next - step);
    step = next;
    clock.charge("sweep");
    if (loads) observers.add_loads(fluid.loads());
    clock.charge("loads");
    observers.after_interval(step - 1, fluid, nullptr);
    if (every > 0 && fluid.steps() % every == 0) save(checkpoint, plan, fluid, observers);
    clock.charge("output");
    protocol::throw_if_signalled();
    if (observers.steady()) {
      ending = fmt::format("steady: the velocity changes by less than {} a turnover",
                           scene.steady_below);
      break;
    }
  }
  observers.at_end(step, fluid, nullptr);
  clock.charge("output");
  const Summary summary = summarise(scene, options, observers, clock, ending);
  write_summary(options.out, summary);
  return summary;
}

}  // namespace lbm
