// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "lbm_solver/base/scene.h"
#include "lbm_solver/solver/plan.h"

namespace lbm {

/// The times at which a run may be stopped: it goes on from there to the bit, since the solid is
/// set up anew at each of them, as a restart does, whether or not a checkpoint is written.
class StopTimes {
 public:
  StopTimes(const Scene& scene, const Plan& plan) {
    if (scene.checkpoint_every <= 0.0) return;
    const double intervals = std::min(scene.checkpoint_every / plan.interval(), 1e15);
    every_ = std::max<std::int64_t>(1, std::llround(intervals));
  }
  bool any() const { return every_ > 0; }
  /// A checkpoint is written at this state, whatever happens.
  bool checkpoint(std::int64_t state) const { return any() && state % every_ == 0; }
  /// At this state the run may be stopped.
  bool stop(std::int64_t state) const {
    return !any() || state % kMostIntervals == 0 || checkpoint(state);
  }
  /// First state after this one at which a checkpoint is written.
  std::int64_t next_checkpoint(std::int64_t state) const { return (state / every_ + 1) * every_; }

 private:
  static constexpr std::int64_t kMostIntervals = 100;  // that a signal may have to wait
  std::int64_t every_ = 0;                             // intervals between checkpoints; 0: none
};

}  // namespace lbm
