// SPDX-License-Identifier: GPL-2.0-or-later
#include "lbm_solver/solver/viscosity_advice.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "lbm_solver/viscosity/viscosity_law.h"

namespace lbm {
namespace {

// A core's updates of cells a second; seen: 1.4e7 and 1.7e7 in scenes of gel and mud with grains,
// 1.4e8 and more in a fluid alone that is large enough (docs/viscosity.md)
constexpr double kUpdates = 5e7, kUpdatesWithSolids = 2e7;
constexpr double kLeastStep = 2e-6;   // s that the smallest lattice takes
constexpr double kFewestCells = 8.0;  // along the shortest axis, that a coarser cell may leave
constexpr double kSame = 1e-3;        // of a viscosity

double updates(const Scene& s) {
  return s.coupling || !s.obstacles.empty() ? kUpdatesWithSolids : kUpdates;
}

bool is_bound(double viscosity, std::optional<double> bound) {
  return bound && std::abs(viscosity - *bound) <= kSame * *bound;
}

/// Whether the yield stress makes more of the viscosity than the consistency does.
bool mostly_yield(const Scene& s) {
  const ViscosityScene& v = s.fluid.law;
  return v.yield_stress > v.consistency * std::pow(v.shear_rate.value_or(1.0), v.index);
}

std::string key_text(const char* key, double value, const char* unit) {
  return fmt::format("fluid.viscosity.{} = {:.4g} {}: ", key, value, unit);
}

/// ", or a larger fluid.viscosity.shear_rate" where the law takes the viscosity that way.
std::string or_shear_rate(const ViscosityScene& v, bool thinner) {
  if (v.index == 1.0) return "";
  return fmt::format(", or a {} fluid.viscosity.shear_rate, if the fluid flows there",
                     (v.index < 1.0) == thinner ? "larger" : "smaller");
}

/// The consistency, or the bounds, in place of which a scene should have others.
std::string other_value(const Scene& s, bool thinner, const std::string& wanted) {
  const ViscosityScene& v = s.fluid.law;
  const ViscosityParts parts = parts_of(v.model);
  const std::optional<double>& bound = thinner ? v.nu_min : v.nu_max;
  if (!parts.varies) return "is fluid.kinematic_viscosity in m²/s? take " + wanted;
  if (!parts.consistency)
    return "fluid.viscosity.nu_min and nu_max: are they in m²/s? take both " + wanted;
  if (is_bound(s.fluid.viscosity, bound))
    return key_text(thinner ? "nu_min" : "nu_max", *bound, "m²/s") + "is it in m²/s? take it " +
           wanted;
  const char* const unit = parts.index ? "Pa sⁿ" : "Pa s";
  return key_text("consistency", v.consistency, unit) + "is it in " + unit + "? take it " + wanted +
         or_shear_rate(v, thinner);
}

std::string duration_text(double seconds) {
  constexpr std::pair<double, const char*> units[] = {
      {3.15e7, "years"}, {86400.0, "days"}, {3600.0, "h"}, {60.0, "min"}};
  for (const auto& [length, name] : units)
    if (seconds >= length) return fmt::format("{:.2g} {}", seconds / length, name);
  return fmt::format("{:.2g} s", seconds);
}

/// "take a coarser cell or an earlier end, or a ", without the cell where it would leave none.
std::string take_less(const Plan& plan, StepBound bound, double excess) {
  const Cell3 n = plan.domain.cells();
  int shortest = std::min(n[0], n[1]);
  if (n[2] > 1) shortest = std::min(shortest, n[2]);
  const double coarser = bound == StepBound::Relaxation ? std::sqrt(excess) : excess;
  return fmt::format("take {}an earlier end, or a ",
                     shortest >= kFewestCells * coarser ? "a coarser cell or " : "");
}

}  // namespace

std::string way_to_thinner(const Scene& s) {
  if (mostly_yield(s) && !is_bound(s.fluid.viscosity, s.fluid.law.nu_min))
    return key_text("yield_stress", s.fluid.law.yield_stress, "Pa") + kLowerYield;
  return other_value(s, true, "smaller");
}

std::string way_to_thicker(const Scene& s, double times) {
  return other_value(s, false, fmt::format("at least {:.2g} times as large", times));
}

std::string way_to_fewer_steps(const Scene& s, const Plan& plan, double excess) {
  StepBound bound = plan.step_bound;
  if (bound == StepBound::Given) {
    const StepChoice longest = choose_step(s, plan.units.dx, s.fluid.viscosity);
    if (longest.lattice_speed * excess <= plan.lattice_speed)
      return "take an earlier end, or a longer numerics.time_step";
    bound = longest.bound;
  }
  if (bound == StepBound::Speed)
    return take_less(plan, bound, excess) + "smaller fluid.velocity_scale if nothing is that fast";
  if (bound == StepBound::Pressure)
    return take_less(plan, bound, excess) + "smaller difference of pressures";
  if (parts_of(s.fluid.law.model).varies) return way_to_thinner(s);
  return take_less(plan, bound, excess) + "thinner fluid: is the viscosity in m²/s?";
}

const char* way_to_larger_tau(StepBound bound) {
  if (bound == StepBound::Given) return "take a finer cell, or a longer numerics.time_step";
  if (bound == StepBound::Pressure)
    return "take a finer cell, or a smaller difference of pressures, which binds the step";
  return "take a finer cell, or a lower fluid.velocity_scale if nothing is that fast";
}

double run_seconds(const Scene& s, const Plan& plan, double steps) {
  const Cell3 n = plan.domain.cells();
  const double cells = static_cast<double>(n[0]) * n[1] * n[2];
  return steps * std::max(cells / updates(s), kLeastStep);
}

std::string run_time_text(const Scene& s, const Plan& plan, double steps) {
  return fmt::format("some {} on a core at {:.0e} cells a second",
                     duration_text(run_seconds(s, plan, steps)), updates(s));
}

}  // namespace lbm
