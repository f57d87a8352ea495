// SPDX-License-Identifier: GPL-2.0-or-later
/// What both kinds of run keep of themselves: in a checkpoint, and at their end.
#pragma once

#include <string>

#include "lbm_solver/base/errors.h"
#include "lbm_solver/coupling/observers.h"
#include "lbm_solver/coupling/run.h"

namespace lbm {

/// State at which a run ends.
std::int64_t last_interval(const Plan& plan, const RunOptions& options);

/// Takes over a record. @throws InputError  it is of another scene or version
template <class Load>
void load_from(const Restart& restart, Load&& load) try {
  load();
} catch (const std::invalid_argument& error) {
  throw InputError(restart.path, fmt::format("does not fit this scene: {}", error.what()),
                   "start again without --restart");
}

/// What is said of the checkpoint that a run goes on from.
void say_restart(const Restart& restart, Log& log);

/// Seconds that this rank has worked in its steps. @param waited  of those in the sweep, for its
/// neighbours
double work_seconds(const PartClock& clock, double waited);

/// The record of a checkpoint but for the particles: complete on rank 0, elsewhere what it is asked
/// for, the cells. Collective.
/// @param solid_part  see checkpoint_record
/// @throws InputError  the solid's part is not there
Record state_record(const Scene& scene, const Plan& plan, const Fluid& fluid,
                    const Observers& observers, std::int64_t interval,
                    const std::string& solid_part);

/// The summary of a run that has ended. Collective.
/// @param waited  see work_seconds
Summary summarise(const Scene& scene, const RunOptions& options, const Fluid& fluid,
                  const Observers& observers, const PartClock& clock, double waited,
                  const std::string& ending);

/// A warning where one rank has worked much longer than the mean, and what to do.
void say_busiest(const Scene& scene, const Fluid& fluid, const Summary& summary, Log& log);

}  // namespace lbm
