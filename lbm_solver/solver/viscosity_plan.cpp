// SPDX-License-Identifier: GPL-2.0-or-later
#include "lbm_solver/solver/viscosity_plan.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "lbm_solver/base/errors.h"
#include "lbm_solver/solver/creep.h"
#include "lbm_solver/solver/drive_check.h"
#include "lbm_solver/viscosity/mean_law.h"
#include "lbm_solver/viscosity/relaxation_table.h"
#include "lbm_solver/viscosity/viscosity_law.h"

namespace lbm {
namespace {

constexpr double kLargestTau = 400.0;  // above, a step changes the stress by too little
constexpr double kSlowTau = 60.0;      // above, stiff parts answer slowly
constexpr double kLeastTau = 0.501;    // below, the noise of the stress decides
constexpr double kMovedPlug = 5.0;     // τ u/c_s above which TRT thins what moves without yielding
constexpr double kUpdates = 1e8;       // of cells a second, by a core
constexpr double kLeastStep = 2e-6;    // s that the smallest lattice takes
constexpr double kLongRun = 600.0;     // s
constexpr double kMuchLonger = 10.0;   // than without the yield stress
constexpr double kMuchCreep = 0.1;     // of a channel's flow rate

ViscosityLaw law_of(const Scene& s) {
  return {s.fluid, s.fluid.law.shear_rate.value_or(typical_shear_rate(s))};
}

bool yields(const Scene& s) {
  return s.fluid.law.yield_stress > 0.0;
}

double tau_of(const Plan& plan, double viscosity) {
  return 0.5 + 3.0 * viscosity * plan.units.dt / (plan.units.dx * plan.units.dx);
}

/// Least and largest shear rate that are looked at, over the typical one.
constexpr double kSlowest = 1e-9, kFastest = 1e9;

/// Shear rate at which the law leaves a bound, or comes to it [1/s]; 0: it never does.
double shear_rate_at(const ViscosityLaw& law, double bound, bool leaves) {
  for (double rate = kSlowest * law.shear_rate(); rate < kFastest * law.shear_rate(); rate *= 1.01)
    if ((std::abs(law(rate) - bound) <= 0.001 * bound) != leaves) return rate;
  return 0.0;
}

/// Stress without the yield stress at the typical shear rate [Pa].
double viscous_stress(const Scene& s, double rate) {
  return s.fluid.law.consistency * std::pow(rate, s.fluid.law.index);
}

/// Where a bound comes from that the scene does not give; empty where it does.
std::string lower_default(const Scene& s, const ViscosityLaw& law) {
  if (s.fluid.law.nu_min) return "";
  const bool plastic = s.fluid.law.model == ViscosityScene::Model::Bingham &&
                       law.nu_min() == s.fluid.law.consistency / s.fluid.density;
  return plastic ? "default: K/ρ" : "default: a hundredth of the typical one";
}
std::string upper_default(const Scene& s) {
  return s.fluid.law.nu_max ? "" : "default: a hundred times the typical one";
}

/// A bound as messages name it.
std::string bound_text(const char* key, double value, const std::string& origin) {
  return fmt::format("fluid.viscosity.{} = {:.4g} m²/s{}", key, value,
                     origin.empty() ? "" : " (" + origin + ")");
}

/// What the scene leaves open, with what was taken; empty where it gives all.
std::string defaults_text(const Scene& s, const ViscosityLaw& law) {
  std::string text;
  const auto add = [&text](const std::string& part) { text += (text.empty() ? "" : ", ") + part; };
  if (law.shear_rate() == typical_shear_rate(s))  // or the scene gives just that
    add(fmt::format("shear_rate {:.4g} 1/s (velocity_scale over {:.3g} m)", law.shear_rate(),
                    s.fluid.velocity_scale / law.shear_rate()));
  const auto bound = [&](const char* key, double value, const std::string& origin) {
    if (!origin.empty())
      add(fmt::format("{} {:.4g} m²/s ({})", key, value, origin.substr(origin.find(' ') + 1)));
  };
  bound("nu_min", law.nu_min(), lower_default(s, law));
  bound("nu_max", law.nu_max(), upper_default(s));
  return text;
}

void check_bounds(const Scene& s, const ViscosityLaw& law, Plan& plan) {
  const double low = tau_of(plan, law.nu_min()), high = tau_of(plan, law.nu_max());
  const double a_tau = plan.units.dx * plan.units.dx / (3.0 * plan.units.dt);
  const std::string lower = bound_text("nu_min", law.nu_min(), lower_default(s, law)),
                    upper = bound_text("nu_max", law.nu_max(), upper_default(s));
  if (law.nu_min() >= law.nu_max())
    throw InputError(fmt::format("{}: {} is not below {}", s.file, lower, upper),
                     "give nu_min < nu_max");
  if (high > kLargestTau)
    throw InputError(fmt::format("{}: {} has τ = {:.4g}, above {}: the stress there would follow "
                                 "the flow too slowly",
                                 s.file, upper, high, kLargestTau),
                     fmt::format("take at most {:.3g} m²/s, or a smaller numerics.time_step",
                                 (kLargestTau - 0.5) * a_tau));
  // where τ binds, a finer cell has a step that is as much shorter
  const bool finer_helps = plan.step_bound != StepBound::Relaxation;
  if (low - 0.5 < 1e-6) {
    const std::string text =
        fmt::format("{}: {} has τ - ½ = {:.2g}, too small for round-off", s.file, lower, low - 0.5);
    if (yields(s) && !s.fluid.law.nu_min)
      throw InputError(
          fmt::format("{}: yield_stress = {:.4g} Pa is {:.2g} times the viscous stress "
                      "at the typical shear rate, {:.3g} 1/s",
                      text, s.fluid.law.yield_stress,
                      s.fluid.law.yield_stress / viscous_stress(s, law.shear_rate()),
                      law.shear_rate()),
          kLowerYield);
    throw InputError(text, fmt::format("take at least {:.3g} m²/s{}", 1e-3 * a_tau,
                                       finer_helps ? ", or a finer cell" : ""));
  }
  if (high > kSlowTau)
    plan.warnings.push_back(fmt::format(
        "{} has τ = {:.3g}: parts that stiff answer a change of load only after some {:.2g} s; "
        "where that matters take a smaller nu_max or numerics.time_step",
        upper, high, high * plan.units.dt));
  if (low < kLeastTau)
    plan.warnings.push_back(
        fmt::format("{} has τ = {:.5g}: where the fluid is that thin the flow "
                    "is not resolved; take {}a larger nu_min",
                    lower, low, finer_helps ? "a finer cell, or " : ""));
  const double rate = law.shear_rate(), typical = law(rate);
  const auto bound = [&](double nu, const std::string& text) {
    if (std::abs(typical / nu - 1.0) < 1e-3)
      plan.warnings.push_back(fmt::format(
          "at the typical shear rate, {:.3g} 1/s, the viscosity is at {}: the law does not act; "
          "give another bound or fluid.viscosity.shear_rate",
          rate, text));
  };
  bound(law.nu_min(), lower);
  bound(law.nu_max(), upper);
}

std::string duration_text(double seconds) {
  constexpr std::pair<double, const char*> units[] = {
      {3.15e7, "years"}, {86400.0, "days"}, {3600.0, "h"}, {60.0, "min"}};
  for (const auto& [length, name] : units)
    if (seconds >= length) return fmt::format("{:.2g} {}", seconds / length, name);
  return fmt::format("{:.2g} s", seconds);
}

/// A yield stress that makes the run long, since the viscosity that it gives sets the step.
void check_cost(const Scene& s, const ViscosityLaw& law, double plastic, Plan& plan) {
  if (plan.step_bound != StepBound::Relaxation) return;
  const double steps = static_cast<double>(plan.intervals) * plan.fluid_steps,
               longer = plan.lattice_speed / choose_step(s, plan.units.dx, plastic).lattice_speed;
  const Cell3 n = plan.domain.cells();
  const double cells = static_cast<double>(n[0]) * n[1] * n[2],
               seconds = steps * std::max(cells / kUpdates, kLeastStep);
  if (longer < kMuchLonger || seconds < kLongRun) return;
  plan.warnings.push_back(fmt::format(
      "fluid.viscosity.yield_stress = {:.4g} Pa makes {:.3g} m²/s at the typical shear rate, "
      "{:.3g} "
      "1/s, which sets the step: the run takes {:.2g} steps, {:.2g} times as many as without it, "
      "some {} on a core: {}",
      s.fluid.law.yield_stress, law.reference(), law.shear_rate(), steps, longer,
      duration_text(seconds), kLowerYield));
}

/// What the bounds do to the flow rate of the plane channel that a scene is: a part, and words;
/// none where it is no channel that a known stress drives, or where nothing yields.
std::pair<double, std::string> creep_of(const Scene& s, const ViscosityLaw& law) {
  const double viscous = channel_wall_stress(s) - s.fluid.law.yield_stress;
  if (!parts_of(s.fluid.law.model).consistency || viscous <= 0.0) return {};
  const double rate = std::pow(viscous / s.fluid.law.consistency, 1.0 / s.fluid.law.index);
  const double part = creep_in_channel(s.fluid, law, rate);
  const std::string plug = yields(s) ? fmt::format(", where {:.2g} of its width do not yield",
                                                   plug_in_channel(s.fluid, rate))
                                     : "";
  return {part, fmt::format("nu_min and nu_max change the flow rate of this channel by {:+.2g} %, "
                            "at {:.3g} 1/s at its walls{}; the grid's error comes on top",
                            100.0 * part, rate, plug)};
}

void check_creep(const Scene& s, const ViscosityLaw& law, Plan& plan) {
  if (const auto [part, text] = creep_of(s, law); std::abs(part) > kMuchCreep)
    plan.warnings.push_back("fluid.viscosity: " + text + "; take " +
                            (part > 0.0 ? "a larger nu_max" : "a smaller nu_min"));
}

/// A yield stress that costs much, or beside which the rest of the law is cut off.
void check_yield(const Scene& s, const ViscosityLaw& law, Plan& plan) {
  if (!yields(s)) return;
  const double rate = law.shear_rate(), viscous = viscous_stress(s, rate);
  const double plastic = viscous / rate / s.fluid.density;
  check_cost(s, law, plastic, plan);
  if (law.nu_min() > 1.001 * plastic)
    plan.warnings.push_back(
        fmt::format("{} is above what the fluid has without its yield stress at the typical shear "
                    "rate, {:.4g} m²/s: where it flows it is thicker than its law; give a nu_min "
                    "below that",
                    bound_text("nu_min", law.nu_min(), lower_default(s, law)), plastic));
}

/// Operators that do not fit a fluid that yields (docs/viscosity.md, "Limits").
void check_operator(const Scene& s, const ViscosityLaw& law, Plan& plan) {
  if (!yields(s)) return;
  const CollisionOperator collision = plan.kernel.collision;
  if (collision == CollisionOperator::Bgk)
    plan.warnings.push_back(
        "numerics.collision = \"bgk\" lets 15 to 24 % too much of a fluid with a yield stress "
        "through a channel, on any cell: its slip at walls grows with τ; take another one");
  const double moved = tau_of(plan, law.nu_max()) * std::numbers::sqrt3 * s.fluid.velocity_scale *
                       plan.units.dt / plan.units.dx;
  if (collision == CollisionOperator::Trt && moved > kMovedPlug)
    plan.warnings.push_back(fmt::format(
        "numerics.collision = \"trt\" makes mud thinner than nu_max where it is carried along "
        "without yielding: τ u/c_s = {:.3g} at fluid.velocity_scale, above {}; take "
        "\"central_moment\", or a smaller nu_max or time_step",
        moved, kMovedPlug));
}

/// Radius of the smallest round body [cells]; 0: there is none.
double smallest_radius(const Scene& s, double dx) {
  double diameter = s.particles ? s.particles->diameter.lo : 0.0;
  for (const ObstacleScene& o : s.obstacles)
    if (o.round && (diameter == 0.0 || o.diameter < diameter)) diameter = o.diameter;
  return 0.5 * diameter / dx;
}

}  // namespace

void plan_viscosity(const Scene& s, Plan& plan) {
  const ViscosityLaw law = law_of(s);
  if (law.newtonian()) return;
  check_yield(s, law, plan);
  check_bounds(s, law, plan);
  check_creep(s, law, plan);
  check_operator(s, law, plan);
  if (s.coupling && s.coupling->lubrication_range > 0.0)
    throw InputError(s.file + ": coupling.lubrication_range",
                     "is a Newtonian law, and the viscosity here depends on the shear rate",
                     "leave it out");
  const double dt = plan.units.dt, to_tau = 3.0 * dt / (plan.units.dx * plan.units.dx);
  const double eddies = 3.0 * std::pow(s.numerics.smagorinsky, 2);  // (S_c h)² γ̇, h a cell
  const auto tau = [=](double rate) { return 0.5 + to_tau * law(rate / dt) + eddies * rate; };
  try {
    CollisionParameters& p = plan.kernel.parameters;
    p.viscosity_table = std::make_shared<RelaxationTable>(tau);
    if (const double radius = smallest_radius(s, plan.units.dx); radius > 0.0)
      p.covered_table = std::make_shared<RelaxationTable>(
          MeanLaw(tau, MeanLaw::spread_beside(radius, s.box.dimension)));
  } catch (const std::invalid_argument& error) {
    throw InputError(s.file + ": fluid.viscosity", error.what(), "check its numbers");
  }
}

std::vector<std::string> describe_viscosity(const Scene& s, const Plan& plan) {
  const ViscosityLaw law = law_of(s);
  if (law.newtonian()) return {};
  const ViscosityScene& v = s.fluid.law;
  const double rate = law.shear_rate(), nu = law.reference();
  std::vector<std::string> lines;
  std::string text = name_of(v.model);
  const ViscosityParts parts = parts_of(v.model);
  if (parts.consistency)
    text += fmt::format(", K {:.4g} Pa s{}", v.consistency, parts.index ? "ⁿ" : "");
  if (parts.index) text += fmt::format(", n {:.4g}", v.index);
  if (yields(s))
    text += fmt::format(", σ_y {:.4g} Pa ({})", v.yield_stress,
                        v.regularisation == ViscosityScene::Regularisation::Papanastasiou
                            ? "Papanastasiou"
                            : "bi-viscosity");
  if (parts.time_constant) text += fmt::format(", λ {:.4g} s", v.time_constant);
  lines.push_back(text +
                  fmt::format("; ν {:.4g} m²/s at the typical shear rate {:.4g} 1/s", nu, rate));
  const bool thickens = law(kFastest * rate) > law(kSlowest * rate);
  const double slow = shear_rate_at(law, thickens ? law.nu_min() : law.nu_max(), true),
               fast = shear_rate_at(law, thickens ? law.nu_max() : law.nu_min(), false);
  lines.push_back(fmt::format(
      "ν {:.4g} … {:.4g} m²/s, τ {:.5g} … {:.4g}; the law acts from {:.3g} to {} 1/s", law.nu_min(),
      law.nu_max(), tau_of(plan, law.nu_min()), tau_of(plan, law.nu_max()), slow,
      fast > 0.0 ? fmt::format("{:.3g}", fast) : "any number of"));
  if (yields(s)) {
    lines.push_back(
        fmt::format("Bingham number {:.3g}, yield stress over viscous stress at {:.3g} "
                    "1/s",
                    v.yield_stress / viscous_stress(s, rate), rate));
  }
  if (const std::string creep = creep_of(s, law).second; !creep.empty()) lines.push_back(creep);
  if (const std::string text = defaults_text(s, law); !text.empty())
    lines.push_back("by default " + text);
  return lines;
}

}  // namespace lbm
