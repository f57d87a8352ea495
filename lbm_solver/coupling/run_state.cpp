// SPDX-License-Identifier: GPL-2.0-or-later
#include "lbm_solver/coupling/run_state.h"

#include <algorithm>
#include <array>
#include <cstdlib>
#include <ctime>
#include <fstream>

#include "lbm_solver/coupling/restart.h"
#include "lbm_solver/solver/work.h"

namespace lbm {
namespace {

constexpr double kBusy = 1.25;      // times the mean from which a warning is due
constexpr double kShortest = 10.0;  // seconds of a run below which times say little

/// Bytes that this process has had in memory at most; 0 where the system does not tell.
double peak_memory() {
  std::ifstream status("/proc/self/status");
  for (std::string line; std::getline(status, line);)
    if (line.starts_with("VmHWM:")) return 1024.0 * std::strtod(line.c_str() + 6, nullptr);
  return 0.0;
}

/// Largest over the ranks, and sum. Collective.
std::array<double, 2> most_and_sum(const Decomposition& ranks, double mine) {
  std::array<double, 1> sum{mine};
  ranks.sum(sum);
  return {ranks.max(mine), sum[0]};
}

}  // namespace

std::int64_t last_interval(const Plan& plan, const RunOptions& options) {
  if (!options.until) return plan.intervals;
  return std::clamp<std::int64_t>(first_state(*options.until, plan.interval()), 1, plan.intervals);
}

void say_restart(const Restart& restart, Log& log) {
  if (restart.earlier)
    log.say(restart.interval, "warning", "the last checkpoint is not used: {}", restart.remark);
  log.say(restart.interval, "restart", "goes on from {}", restart.path);
}

double work_seconds(const PartClock& clock, double waited) {
  double seconds = -waited;
  for (const char* part : {"sweep", "placing", "loads"})
    if (const auto found = clock.parts().find(part); found != clock.parts().end())
      seconds += found->second;
  return seconds;
}

Record state_record(const Scene& scene, const Plan& plan, const Fluid& fluid,
                    const Observers& observers, std::int64_t interval,
                    const std::string& solid_part) {
  Record record;
  if (fluid.ranks().rank() == 0) record = checkpoint_record(scene, plan, interval, solid_part);
  record.set("fluid", fluid.save());
  record.set("observers", observers.save());
  if (fluid.has_solids()) record.set("work", save(work_of(fluid)));
  return record;
}

Summary summarise(const Scene& scene, const RunOptions& options, const Fluid& fluid,
                  const Observers& observers, const PartClock& clock, double waited,
                  const std::string& ending) {
  Summary summary = observers.summary(clock.total());
  summary.scene = scene.title;
  summary.set = options.set;
  summary.variant = options.variant;
  summary.versions["lbm"] = BPLBM_VERSION;
  summary.ending = ending;
  summary.cpu_seconds = static_cast<double>(std::clock()) / CLOCKS_PER_SEC;
  for (const auto& [part, seconds] : clock.parts())
    summary.time_share[part] = seconds / clock.total();
  if (const auto found = clock.parts().find("checkpoint"); found != clock.parts().end())
    summary.writing["checkpoints"] = found->second;
  for (const auto& [part, bytes] : fluid.bytes()) summary.megabytes[part] = 1e-6 * bytes;
  const double peak = peak_memory();
  const auto [largest, all] = most_and_sum(fluid.ranks(), peak);
  summary.peak_megabytes = {
      {"first_rank", 1e-6 * peak}, {"largest", 1e-6 * largest}, {"all", 1e-6 * all}};
  const auto [busiest, work] = most_and_sum(fluid.ranks(), work_seconds(clock, waited));
  if (work > 0.0) summary.busiest_rank = busiest * fluid.ranks().size() / work;
  return summary;
}

void say_busiest(const Scene& scene, const Fluid& fluid, const Summary& summary, Log& log) {
  if (fluid.ranks().alone() || summary.busiest_rank < kBusy || summary.wall_seconds < kShortest)
    return;
  log.say(summary.steps, "ranks", "the busiest has worked {:.2f} times as long as the mean: {}",
          summary.busiest_rank,
          scene.numerics.equal_work || !fluid.has_solids()
              ? "are the cores shared with other jobs?"
              : "numerics.blocks = \"equal_work\" moves the cuts to where the solids are");
}

}  // namespace lbm
