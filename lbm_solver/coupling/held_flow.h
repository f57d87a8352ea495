// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <map>
#include <optional>
#include <string>

#include "lbm_solver/io/probe_writer.h"
#include "lbm_solver/solver/plan.h"

namespace lbm {

/// Writes a flow that is held, and what drives it, to `flow.csv`, in SI units: a pressure gradient
/// in place of a body force, or the pressure on an opening.
class HeldFlow {
 public:
  static bool wanted_by(const Scene& scene);
  /// @param keep_until  a run that goes on keeps the lines before this time
  HeldFlow(const Scene& scene, const Plan& plan, const Decomposition& ranks,
           const std::string& folder, double keep_until);

  /// Collective.
  void write(double time, const Fluid& fluid);
  /// The last line's, for the summary.
  void describe(std::map<std::string, double>& parameters) const;

 private:
  const Units units_;
  const bool by_force_;
  double to_flow_;                  // unit of the flow that is measured [m³/s]
  std::optional<CsvWriter> table_;  // of rank 0
  double flow_ = 0.0, wanted_ = 0.0, drive_ = 0.0;
};

}  // namespace lbm
