// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <optional>
#include <string>

#include "lbm_solver/coupling/observers.h"
#include "lbm_solver/coupling/restart.h"
#include "protocol/wire/session.h"

namespace lbm {

struct RunOptions {
  std::string out = "out";      ///< folder of all output; created where missing
  std::optional<double> until;  ///< stop at this time [s] instead of the scene's end
  RestartOptions restart;
  std::string set = "resolved", variant;  ///< names for the summary
};

/// Runs a coupled scene to its end; rank 0 writes its summary.
/// @param ranks    that share the box: all call it
/// @param restart  what it goes on from; null: it begins anew
/// @throws ProgramError and its kinds; what was written until then stays
Summary run_coupled(const Scene& scene, const Plan& plan, const Decomposition& ranks,
                    protocol::Channel& channel, const RunOptions& options, Log& log,
                    const Restart* restart = nullptr);

/// Refuses an `until` that is no time of the scene. @throws InputError
void check_until(const Scene& scene, const RunOptions& options);

/// Runs a scene without a solid program.
Summary run_alone(const Scene& scene, const Plan& plan, const Decomposition& ranks,
                  const RunOptions& options, Log& log, const Restart* restart = nullptr);

}  // namespace lbm
