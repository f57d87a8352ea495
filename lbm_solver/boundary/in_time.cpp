// SPDX-License-Identifier: GPL-2.0-or-later
#include "lbm_solver/boundary/in_time.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace lbm {

double TimeTable::factor(double step) const {
  if (repeats) {
    const double period = steps.back() - steps.front(), since = step - steps.front();
    step = steps.front() + since - period * std::floor(since / period);
  }
  const auto after = std::ranges::upper_bound(steps, step);
  if (after == steps.begin()) return factors.front();
  if (after == steps.end()) return factors.back();
  const auto i = static_cast<std::size_t>(after - steps.begin());
  return std::lerp(factors[i - 1], factors[i], (step - steps[i - 1]) / (steps[i] - steps[i - 1]));
}

double InTime::ramp(std::int64_t step) const {
  const double t = static_cast<double>(step);
  return t < ramp_steps ? 0.5 * (1.0 - std::cos(std::numbers::pi * t / ramp_steps)) : 1.0;
}

double InTime::wave(std::int64_t step) const {
  const double t = static_cast<double>(step);
  const double part = table ? table->factor(t) : 1.0;
  return period_steps > 0.0 ? part * std::cos(2.0 * std::numbers::pi * t / period_steps) : part;
}

}  // namespace lbm
