// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <algorithm>
#include <array>
#include <string>
#include <vector>

#include "lbm_solver/base/record.h"
#include "lbm_solver/base/scene.h"
#include "lbm_solver/coupling/output_times.h"
#include "lbm_solver/solver/fluid.h"
#include "lbm_solver/solver/plan.h"

namespace lbm {

/// Means of velocity and pressure over time in every cell, and the root mean squares of what
/// deviates from them, by Welford's sums: a steady field is its own mean, and deviates by nothing.
/// The pressure counts where there is fluid.
class FieldAverage {
 public:
  FieldAverage(const AverageScene& scene, const Plan& plan, const Decomposition& ranks);

  bool due(std::int64_t state) const { return state >= first_ && times_.due(state); }
  /// First state from this one on at which a sample is due.
  std::int64_t next(std::int64_t state) const { return times_.next(std::max(state, first_)); }
  void add(double time, Fluid& fluid);
  /// Writes `averages.h5` where there is a sample. Collective.
  void write(const std::string& folder, const Units& units) const;

  /// To be written before the next sample: its sums are read from here.
  Record save() const;
  /// @throws std::invalid_argument where it is of another box
  void load(const Record& record);
  /// See Observers. What was summed so far is lost until `load`.
  void move_to(const Decomposition& ranks);

 private:
  /// Mean and sum of squares of deviations of one quantity in each cell of this rank.
  struct Moments {
    std::vector<double> mean, squares;
    void add(std::size_t cell, double value, double count);
  };
  void fill(const CellRange& piece, std::span<float> to, const Units& units, double count) const;

  Decomposition ranks_;
  const OutputTimes times_;
  std::int64_t first_ = 0;  // state from which on
  std::int64_t samples_ = 0;
  double from_ = 0.0, to_ = 0.0;
  std::array<Moments, 3> velocity_;  // lattice units
  Moments pressure_;                 // ρ - 1
  std::vector<double> fluid_;        // samples with fluid
};

}  // namespace lbm
