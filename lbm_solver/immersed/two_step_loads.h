// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <cstdint>
#include <span>
#include <unordered_map>
#include <vector>

#include "lbm_solver/base/record.h"
#include "lbm_solver/field/domain.h"
#include "lbm_solver/immersed/body.h"

namespace lbm {

class Decomposition;

/// Loads with a part of those of the step before (load_lag), by the ids of the bodies.
class TwoStepLoads {
 public:
  explicit TwoStepLoads(double lag) : lag_(lag) {}
  bool on() const { return lag_ > 0.0; }

  /// What the sweep left on the bodies in the last step: what the next one needs of it.
  void remember(std::span<const Body> bodies, std::span<const BodyLoad> raw);
  /// @param raw  loads of the last step; a body that was not there before has these
  std::vector<BodyLoad> mean(std::span<const Body> bodies, std::span<const BodyLoad> raw,
                             const Domain& domain, const Block& cells) const;

  /// Loads of the step before, complete on rank 0; `load` wants them on every rank. Collective.
  Record save(const Decomposition& ranks) const;
  void load(const Record& record);

 private:
  double lag_;
  std::unordered_map<std::int64_t, BodyLoad> before_;
  bool of_all_ranks_ = false;  // after a restart: the rank that holds the centre has all of it
};

}  // namespace lbm
