// SPDX-License-Identifier: MIT
/// One check as an MPI job of this program and the engine.
#pragma once

#include <string>
#include <vector>

#include "tools/engines/conformance/checks.h"

namespace conformance {

struct JobOptions {
  int fluid_ranks = 1, solid_ranks = 1;
  double timeout = 30.0;   ///< of a check [s]
  double patience = 20.0;  ///< how long the engine may take for an answer [s]
  std::string launcher = "mpirun";
  std::vector<std::string> engine;  ///< command and arguments
};

struct Outcome {
  std::string wrong;  ///< what the engine has done wrong; empty: it has passed
  std::string said;   ///< lines of both programs that tell why
  double seconds = 0.0;
};

/// Runs it. Ends everything that it has started.
Outcome run_check(const Check& check, const JobOptions& options);

/// What a rank of the judge writes for run_check: "ok", or what was wrong.
void write_verdict(const std::string& folder, int rank, const std::string& verdict);

}  // namespace conformance
