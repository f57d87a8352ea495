// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <chrono>
#include <map>
#include <string>
#include <utility>

namespace lbm {

/// Wall time by part of the time step.
class PartClock {
 public:
  /// Charges the time since the last call to `part`. @return  it [s]
  double charge(const char* part) {
    const auto begin = std::exchange(last_, Clock::now());
    const double seconds = std::chrono::duration<double>(last_ - begin).count();
    seconds_[part] += seconds;
    return seconds;
  }
  double total() const { return std::chrono::duration<double>(last_ - start_).count(); }
  const std::map<std::string, double>& parts() const { return seconds_; }

 private:
  using Clock = std::chrono::steady_clock;
  Clock::time_point start_ = Clock::now(), last_ = start_;
  std::map<std::string, double> seconds_;
};

}  // namespace lbm
