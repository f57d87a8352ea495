// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace lbm {

inline constexpr double kNever = 1e15;  // intervals, more than any run has

/// A run passes through states 0, 1, 2, …: state k is the one after k coupling intervals T (steps
/// of a fluid alone), at the time k T. Whoever asks which state belongs to a time asks here.
///
/// The first state at or after a time. Times and intervals come from decimal numbers and
/// divisions, so a state that is earlier by their rounding alone counts as being there.
inline std::int64_t first_state(double time, double interval) {
  const double intervals = std::min(time / interval, kNever);
  return static_cast<std::int64_t>(std::ceil(intervals - 1e-6 - 1e-15 * intervals));
}

/// The states at which one kind of output is due: 0, and the first at or after each multiple of a
/// time. Found anew from whole numbers every time, so that nothing adds up and a run that goes on
/// from a checkpoint has the same ones.
class OutputTimes {
 public:
  /// @param every     between two outputs [s]; up to an interval: every state
  /// @param interval  T [s]
  OutputTimes(double every, double interval) : every_(std::clamp(every / interval, 1.0, kNever)) {}

  bool due(std::int64_t state) const { return next(state) == state; }

  /// First state from this one on at which output is due.
  std::int64_t next(std::int64_t state) const {
    double count = std::max(0.0, std::floor(static_cast<double>(state) / every_) - 1.0);
    while (first_state(count * every_, 1.0) < state && count * every_ < kNever) ++count;
    return first_state(count * every_, 1.0);
  }

 private:
  double every_;  // intervals
};

}  // namespace lbm
