// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

namespace lbm {

/// Factor of a value at some times, straight between them. Before the first and after the last it
/// stays as it is there, or it begins anew after the last.
struct TimeTable {
  std::vector<double> steps;    ///< rising
  std::vector<double> factors;  ///< as many
  bool repeats = false;         ///< the last is the first of the next period

  double factor(double step) const;
};

/// How a value depends on time: it comes up smoothly, ½(1 - cos), and may oscillate or follow a
/// table.
struct InTime {
  double ramp_steps = 0.0;                           ///< full value from then on
  double period_steps = 0.0;                         ///< 0: steady; else cos(2 pi step / period)
  std::shared_ptr<const TimeTable> table = nullptr;  ///< null: 1

  double ramp(std::int64_t step) const;
  double wave(std::int64_t step) const;
  double factor(std::int64_t step) const { return ramp(step) * wave(step); }
  /// Whether it still changes after a step.
  bool changes_after(std::int64_t step) const {
    return static_cast<double>(step) < ramp_steps || period_steps > 0.0 || table;
  }
};

}  // namespace lbm
