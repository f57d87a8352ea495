// SPDX-License-Identifier: GPL-2.0-or-later
/// What both kinds of run keep of themselves: in a checkpoint, and at their end.
#pragma once

#include <string>

#include "lbm_solver/coupling/observers.h"

namespace lbm {

/// The record of a checkpoint but for the particles: complete on rank 0, elsewhere what it is asked
/// for, the cells. Collective.
/// @param solid_part  see checkpoint_record
/// @throws InputError  the solid's part is not there
Record state_record(const Scene& scene, const Plan& plan, const Fluid& fluid,
                    const Observers& observers, std::int64_t interval,
                    const std::string& solid_part);

/// The summary of a run that has ended. Collective.
Summary summarise(const Scene& scene, const std::string& set, const std::string& variant,
                  const Fluid& fluid, const Observers& observers, const PartClock& clock,
                  const std::string& ending);

/// A warning where one rank has worked much longer than the mean, and what to do.
void say_busiest(const Scene& scene, const Fluid& fluid, const Summary& summary, Log& log);

}  // namespace lbm
