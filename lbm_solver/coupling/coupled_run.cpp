// SPDX-License-Identifier: GPL-2.0-or-later
#include "lbm_solver/coupling/coupled_run.h"

#include <cmath>
#include <ctime>

namespace lbm {
namespace {

std::int64_t last_interval(const Plan& plan, const RunOptions& options) {
  if (!options.until) return plan.intervals;
  const double intervals = std::ceil(*options.until / plan.interval() - 1e-9);
  return std::min(plan.intervals, std::max<std::int64_t>(1, static_cast<std::int64_t>(intervals)));
}

}  // namespace

Summary run_coupled(const Scene& scene, const Plan& plan, protocol::Channel& channel,
                    const RunOptions& options, Log& log) {
  protocol::FluidSession solid(channel, make_hello(scene, plan), scene.coupling->timeout);
  Fluid fluid(plan.domain, plan.kernel);
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
      observers.at_end(interval, fluid, particles);
      break;
    }
    for (int step = 0; step < plan.fluid_steps; ++step) {
      fluid.place(particles.discs(step * plan.units.dt));
      clock.charge("placing");
      fluid.step();
      clock.charge("sweep");
      particles.add(fluid.loads());
      clock.charge("loads");
    }
    solid.answer(particles.mean_loads(plan.fluid_steps),
                 interval + 1 >= end ? protocol::kStop : protocol::kContinue);
    clock.charge("exchange");
    observers.after_interval(interval, fluid, particles);
    clock.charge("output");
  }
  clock.charge("output");

  Summary summary = observers.summary(clock.total());
  summary.scene = scene.title;
  summary.set = options.set;
  summary.variant = options.variant;
  summary.versions = {{"lbm", BPLBM_VERSION},
                      {partner.program, partner.program_version},
                      {"protocol", fmt::format("{}", protocol::kProtocolVersion)}};
  summary.ending = ending;
  summary.cpu_seconds = static_cast<double>(std::clock()) / CLOCKS_PER_SEC;
  for (const auto& [part, seconds] : clock.parts())
    summary.time_share[part] = seconds / clock.total();
  summary.waiting = clock.parts().at("waiting");
  write_summary(options.out, summary);
  return summary;
}

}  // namespace lbm
