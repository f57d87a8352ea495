// SPDX-License-Identifier: GPL-2.0-or-later
#include "lbm_solver/coupling/coupled_run.h"

#include <cmath>
#include <ctime>

#include "protocol/program.h"

namespace lbm {
namespace {

std::int64_t last_interval(const Plan& plan, const RunOptions& options) {
  if (!options.until) return plan.intervals;
  const double intervals = std::ceil(*options.until / plan.interval() - 1e-9);
  return std::min(plan.intervals, std::max<std::int64_t>(1, static_cast<std::int64_t>(intervals)));
}

/// Completes the summary of a run and writes it.
Summary finish(const Scene& scene, const RunOptions& options, const Observers& observers,
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
  const std::vector<Disc> obstacles = obstacle_discs(scene, plan);
  Particles particles(plan.units, scene.fluid, *scene.coupling);
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
    if (arrival.head.flags & protocol::kLast) {
      observers.at_end(interval, fluid, &particles);
      break;
    }
    for (int step = 0; step < plan.fluid_steps; ++step) {
      std::vector<Disc> discs = obstacles;
      const auto moving = particles.discs(step * plan.units.dt);
      discs.insert(discs.end(), moving.begin(), moving.end());
      fluid.place(discs);
      clock.charge("placing");
      fluid.step();
      clock.charge("sweep");
      const std::vector<DiscLoad> loads = fluid.loads();
      const std::span all(loads);
      if (!obstacles.empty()) observers.add_loads(all.first(obstacles.size()));
      particles.add(all.subspan(obstacles.size()));
      clock.charge("loads");
    }
    solid.answer(particles.mean_loads(plan.fluid_steps),
                 interval + 1 >= end ? protocol::kStop : protocol::kContinue);
    clock.charge("exchange");
    observers.after_interval(interval, fluid, &particles);
    clock.charge("output");
  }
  clock.charge("output");

  Summary summary = finish(scene, options, observers, clock, ending);
  summary.versions[partner.program] = partner.program_version;
  summary.versions["protocol"] = fmt::format("{}", protocol::kProtocolVersion);
  summary.waiting = clock.parts().at("waiting");
  write_summary(options.out, summary);
  return summary;
}

Summary run_alone(const Scene& scene, const Plan& plan, const RunOptions& options, Log& log) {
  Fluid fluid = make_fluid(scene, plan);
  const bool loads = !obstacle_discs(scene, plan).empty();
  Observers observers(scene, plan, options.out, log);
  const std::int64_t end = last_interval(plan, options);
  std::string ending = "complete";
  PartClock clock;
  std::int64_t step = 0;
  for (; step < end; ++step) {
    fluid.step();
    clock.charge("sweep");
    if (loads) observers.add_loads(fluid.loads());
    clock.charge("loads");
    observers.after_interval(step, fluid, nullptr);
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
  const Summary summary = finish(scene, options, observers, clock, ending);
  write_summary(options.out, summary);
  return summary;
}

}  // namespace lbm
