// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <vector>

#include "lbm_solver/base/record.h"
#include "lbm_solver/solver/plan.h"

namespace lbm {

/// Tells when a fluid alone no longer changes (run.steady_below): compares the velocity field with
/// that of the look before, largest change over largest velocity, a unit of box length over
/// velocity scale.
class SteadyWatch {
 public:
  SteadyWatch(const Scene& scene, const Plan& plan, std::int64_t steps_between_looks);
  /// Collective.
  void look(Fluid& fluid);
  bool steady() const { return steady_; }

  /// Complete on rank 0, which alone needs it in `load`. Collective.
  Record save(const Decomposition& ranks) const;
  void load(const Record& record, const Decomposition& ranks);

 private:
  double looks_a_turnover_, limit_;
  std::vector<double> before_;  // velocity, three components a cell; empty before the first look
  bool steady_ = false;
};

}  // namespace lbm
