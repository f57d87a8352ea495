// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <span>
#include <string>
#include <vector>

#include "lbm_solver/immersed/disc.h"
#include "lbm_solver/io/probe_writer.h"
#include "lbm_solver/solver/plan.h"

namespace lbm {

/// Writes the mean loads on the scene's obstacles since the line before to `obstacles.csv`, in SI
/// units: a line for each obstacle by its number from 1, and one numbered 0 for the sum over the
/// grains of a file.
class ObstacleLoads {
 public:
  /// @param keep_until  a run that goes on keeps the lines before this time
  ObstacleLoads(const Scene& scene, const Plan& plan, const std::string& folder, double keep_until);

  /// After each fluid step: loads in the order of obstacle_discs.
  void add(std::span<const DiscLoad> loads);
  void write(double time);

  std::vector<double> state() const;
  void restore(std::span<const double> state);

 private:
  const Units units_;
  CsvWriter table_;
  std::vector<int> line_;       // [obstacle]: into sums_
  std::vector<DiscLoad> sums_;  // since the last line; 0: grains
  bool has_grains_ = false;
  int steps_ = 0;
};

}  // namespace lbm
