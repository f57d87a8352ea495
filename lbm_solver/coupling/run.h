// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <optional>
#include <string>

#include "lbm_solver/coupling/observers.h"
#include "protocol/session.h"

namespace lbm {

struct RunOptions {
  std::string out = "out";      ///< folder of all output; created where missing
  std::optional<double> until;  ///< stop at this time [s] instead of the scene's end
  std::string restart;  ///< go on from "checkpoint" or "fault" in `out`; empty: from the start
  std::string set = "resolved", variant;  ///< names for the summary
};

/// Runs a coupled scene to its end; rank 0 writes its summary.
/// @param ranks  that share the box: all call it
/// @throws ProtocolError and its kinds; what was written until then stays
Summary run_coupled(const Scene& scene, const Plan& plan, const Decomposition& ranks,
                    protocol::Channel& channel, const RunOptions& options, Log& log);

/// Step of the run that a restart goes on from [s]; nothing where it does not.
/// @throws InputError  there is no such checkpoint
std::optional<double> step_to_keep(const Scene& scene, const RunOptions& options);

/// Refuses an `until` that is no time of the scene. @throws InputError
void check_until(const Scene& scene, const RunOptions& options);

/// Runs a scene without a solid program.
Summary run_alone(const Scene& scene, const Plan& plan, const Decomposition& ranks,
                  const RunOptions& options, Log& log);

}  // namespace lbm
