// SPDX-License-Identifier: GPL-2.0-or-later
/// What to do about a viscosity that a lattice cannot carry, or not in reasonable time, by the key
/// of the scene that makes it so.
#pragma once

#include <string>

#include "lbm_solver/solver/plan.h"

namespace lbm {

/// τ at the viscosity of the fluid: more makes walls inexact, less than this above ½ is round-off.
inline constexpr double kStopTau = 3.0, kLeastExcess = 1e-6;

inline constexpr double kMostSteps = 1e12;  ///< that a run may need

/// What to do about a yield stress that is too large.
inline constexpr const char* kLowerYield =
    "is it in Pa? take a lower one, or the fluid.viscosity.shear_rate at which the fluid flows";

/// Where the viscosity at the typical shear rate is too large.
std::string way_to_thinner(const Scene& scene);

/// Where it is too small. @param times  that it should be larger, at least
std::string way_to_thicker(const Scene& scene, double times);

/// Where more steps are needed than any machine can do: what makes them longer, and what may. A
/// step that the scene gives can be longer only as far as the viscosity and the speed let it.
/// @param excess  steps needed over steps allowed
std::string way_to_fewer_steps(const Scene& scene, const Plan& plan, double excess);

/// What makes τ - ½ larger, and may be done where something else than τ binds the step.
const char* way_to_larger_tau(StepBound bound);

/// Seconds that a core takes for steps, roughly: two or three times as fast without solids, and on
/// the largest lattices slower.
double run_seconds(const Scene& scene, const Plan& plan, double steps);

/// The same in words: "some 3 h on a core at 2e+07 cells a second".
std::string run_time_text(const Scene& scene, const Plan& plan, double steps);

}  // namespace lbm
