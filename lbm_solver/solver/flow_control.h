// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <cstdint>

#include "lbm_solver/base/record.h"
#include "lbm_solver/base/vec3.h"
#include "lbm_solver/boundary/in_time.h"

namespace lbm {

class Fluid;

/// Finds the body force along a periodic axis that gives a flow. Every Δ steps
///   F ← F - (U - U')/Δ + (U₀ - U)/T,
/// with U the mean velocity of the box and U' that of Δ steps before. F - (U - U')/Δ is what the
/// solids took from the fluid since then, so that no estimate of their resistance is needed:
///   dU/dt = (U₀ - U)/T
/// where the fluid answers slower than within Δ. Where it answers at once, F still comes to rest
/// for Δ < T, and only at U = U₀. Lattice units.
class FlowControl {
 public:
  /// @param mean_velocity  U₀
  /// @param in_time        its factor over time
  /// @param cells          of the box along the axis: T is the time in which sound crosses it
  ///                       about one and a half times, Δ a tenth of that
  FlowControl(int axis, double mean_velocity, const InTime& in_time, int cells);

  /// Δ [steps]. @param cells  of the box along the axis
  static std::int64_t look_every(int cells);

  int axis() const { return axis_; }
  double force() const { return force_; }
  /// U of the last look.
  double mean_velocity() const { return mean_; }
  double wanted(std::int64_t step) const { return target_ * in_time_.factor(step); }

  bool due(std::int64_t step) const { return step % every_ == 0; }
  /// Steps from one step to the next look.
  std::int64_t until_next(std::int64_t step) const { return every_ - step % every_; }
  /// @param mean_velocity  that of the fluid before a step
  void adjust(std::int64_t step, double mean_velocity);

  Record save() const;
  void load(const Record& record);

 private:
  int axis_;
  double target_;
  InTime in_time_;
  std::int64_t every_;
  double time_;
  double force_ = 0.0, mean_ = 0.0;
};

/// What the momentum of a cell is rounded to, so that momenta may be added up in any order: as fine
/// as 62 bits hold for a box of cells with a velocity of 1.
double momentum_grain(const Cell3& cells);

/// Mean velocity of the box along a periodic axis: what crosses the planes between its layers
/// (PlaneFlow), over all of them. The same on any number of ranks and threads. Collective.
double mean_velocity(const Fluid& fluid, int axis);

}  // namespace lbm
