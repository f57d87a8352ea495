// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <cstdint>
#include <numbers>

#include "lbm_solver/base/record.h"
#include "lbm_solver/boundary/in_time.h"

namespace lbm {

/// Finds the pressure on an opening that gives a flow through it. With u the mean velocity into the
/// box, every kEvery steps
///   p = I + Z (u₀ - u),   I ← I + (Z + |I - p₀|/|u₀|) (u₀ - u) / T a step,
/// Z half of the impedance rho c_s of the fluid, T eight crossings of the box by sound.
///
/// Z makes the opening a soft one: it takes up sound instead of throwing it back, and the inertia
/// of the fluid in the box cannot swing. |I - p₀|/|u₀| is the resistance that was found so far: in
/// a dense bed, where it is far above rho c_s, the pressure grows as e^(t/T) until the flow comes.
/// A box of fluid and solids answers a pressure with a flow of the same sign at every frequency (it
/// is passive), so any positive factors are stable. Lattice units.
class PressureControl {
 public:
  static constexpr std::int64_t kEvery = 4;
  static constexpr double kSound = 1.0 / std::numbers::sqrt3;
  static constexpr double kImpedance = 0.5 * kSound;  ///< Z

  /// @param patch    number of the pressure boundary
  /// @param flow     mass a step into the box @param in_time  its factor over time
  /// @param area     of the opening
  /// @param length   of the box along the opening's axis
  /// @param drho     density deviation to begin with
  PressureControl(std::size_t patch, double flow, const InTime& in_time, double area, int length,
                  double drho);

  /// T, in which it follows [steps]. @param length  of the box along the opening's axis
  static double time(int length);

  std::size_t patch() const { return patch_; }
  /// Density deviation that is to be held on the side.
  double drho() const { return 3.0 * pressure_; }
  /// Mass a step into the box, between the last two looks.
  double flow() const { return flow_; }
  double wanted(std::int64_t step) const { return target_ * in_time_.factor(step); }

  bool due(std::int64_t step) const { return step % kEvery == 0; }
  /// Steps from one step to the next look.
  std::int64_t until_next(std::int64_t step) const { return kEvery - step % kEvery; }
  /// @param mass_in  that has come through the opening since the start
  void adjust(std::int64_t step, double mass_in);

  Record save() const;
  void load(const Record& record);

 private:
  std::size_t patch_;
  double target_;
  InTime in_time_;
  double area_, time_;
  double start_;                // p₀
  double integral_, pressure_;  // I, p
  double mass_in_ = 0.0, flow_ = 0.0;
};

}  // namespace lbm
