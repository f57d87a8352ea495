// SPDX-License-Identifier: GPL-2.0-or-later
/// The time loop of a fluid without a solid program.
#include <algorithm>

#include "lbm_solver/coupling/handshake.h"
#include "lbm_solver/coupling/run.h"
#include "lbm_solver/coupling/run_state.h"
#include "lbm_solver/coupling/stop_times.h"
#include "lbm_solver/io/checkpoint.h"
#include "protocol/program/program.h"

namespace lbm {

Summary run_alone(const Scene& scene, const Plan& plan, const Decomposition& ranks,
                  const RunOptions& options, Log& log, const Restart* restart) {
  if (ranks.rank() == 0) write_meshes(scene, options.out);
  Fluid fluid = make_fluid(scene, plan, ranks);
  if (restart) load_from(*restart, [&] { fluid.load(restart->record.part("fluid")); });
  Observers observers(scene, plan, ranks, options.out, log, fluid.steps());
  if (restart) {
    load_from(*restart, [&] { observers.load(restart->record.part("observers")); });
    say_restart(*restart, log);
  }
  const std::int64_t end = last_interval(plan, options);
  observers.ends_at(end);
  const StopTimes times(scene, plan);
  std::string ending = "complete";
  PartClock clock;
  const std::int64_t first = fluid.steps();
  bool keep_last = !restart || !restart->earlier;
  const auto write_state = [&](std::int64_t step) {
    clock.charge("output");
    const Record record = state_record(scene, plan, fluid, observers, step, "");
    write_checkpoint(fluid_part(options.out, "checkpoint"), record, step,
                     keep_last ? fluid_part_before(options.out, "checkpoint") : "", &ranks);
    keep_last = true;
    clock.charge("checkpoint");
  };
  Fluid::AfterStep add_loads;
  if (observers.sums())
    add_loads = [&] {
      clock.charge("sweep");
      observers.add_loads(fluid, scene.obstacles.empty() ? std::vector<BodyLoad>() : fluid.loads());
      clock.charge("loads");
    };
  const bool moving = has_moving_bodies(scene);
  for (std::int64_t step = first;; step = fluid.steps()) {
    if (moving) fluid.place(obstacle_bodies(scene, plan, step));
    fluid.move_shapes();
    const bool signalled = ranks.max(protocol::signalled() ? 1.0 : 0.0) > 0.0;
    if (signalled)
      ending = "stopped by a signal";
    else if (observers.steady())
      ending = fmt::format("steady: the velocity changes by less than {} a turnover",
                           scene.steady_below);
    const bool last = step >= end || signalled || observers.steady();
    if (times.any() && step > first && (times.checkpoint(step) || signalled)) write_state(step);
    observers.at_state(step, fluid, nullptr, last);
    clock.charge("output");
    if (last) break;
    std::int64_t next = std::min(observers.next_look(step), end);
    if (times.any()) next = std::min(next, times.next_checkpoint(step));
    for (; moving && fluid.steps() < next - 1;
         fluid.place(obstacle_bodies(scene, plan, fluid.steps())))
      fluid.advance(1, add_loads);
    fluid.advance(next - fluid.steps(), add_loads);
    clock.charge("sweep");
    observers.after_interval(next - 1, fluid, nullptr);
    clock.charge("output");
  }
  const Summary summary =
      summarise(scene, options, fluid, observers, clock, fluid.waited(), ending);
  say_busiest(scene, fluid, summary, log);
  if (ranks.rank() == 0) write_summary(options.out, summary);
  return summary;
}

}  // namespace lbm
