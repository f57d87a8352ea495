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
#include "lbm_solver/solver/viscosity_advice.h"
#include "lbm_solver/viscosity/mean_law.h"
#include "lbm_solver/viscosity/relaxation_table.h"
#include "lbm_solver/viscosity/viscosity_law.h"

namespace lbm {
namespace {

constexpr double kLargestTau = 400.0;  // above, a step changes the stress by too little
constexpr double kSlowTau = 60.0;      // above, stiff parts answer slowly
constexpr double kLeastTau = 0.501;    // below, the noise of the stress decides
constexpr double kMovedPlug = 5.0;     // τ u/c_s above which TRT thins what moves without yielding
constexpr double kAFewCells = 4.0;     // times as fine: what a finer cell may be asked for
constexpr double kThickest = 10.0;     // m²/s at the typical shear rate: more than pastes have
constexpr double kLongRun = 600.0;     // s of a core
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

/// Whether nu_min is by default K/ρ.
bool is_plastic(const Scene& s, const ViscosityLaw& law) {
  return !s.fluid.law.nu_min && s.fluid.law.model == ViscosityScene::Model::Bingham &&
         law.nu_min() == s.fluid.law.consistency / s.fluid.density;
}

/// Whether a finer cell makes τ - ½ larger: where τ binds, the step is as much shorter.
bool finer_helps(const Plan& plan) {
  return plan.step_bound != StepBound::Relaxation;
}

/// Where a bound comes from that the scene does not give; empty where it does.
std::string lower_default(const Scene& s, const ViscosityLaw& law) {
  if (s.fluid.law.nu_min) return "";
  return is_plastic(s, law) ? "default: K/ρ" : "default: a hundredth of the typical one";
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

/// Viscosity of τ - ½ = 1 [m²/s].
double nu_of_tau(const Plan& plan) {
  return plan.units.dx * plan.units.dx / (3.0 * plan.units.dt);
}

/// What the fluid has without its yield stress at the typical shear rate [m²/s].
double plastic_viscosity(const Scene& s, double rate) {
  return viscous_stress(s, rate) / rate / s.fluid.density;
}

/// What to do where the yield stress is far above the viscous stress. A lower one helps where the
/// fluid alone, at the step that it would have, is not too thin in its turn.
std::string way_out_of_yield(const Scene& s, const Plan& plan, double rate) {
  const double plastic = plastic_viscosity(s, rate), dx = plan.units.dx;
  const double speed = plan.step_bound == StepBound::Given
                           ? plan.lattice_speed
                           : choose_step(s, dx, plastic).lattice_speed;
  if (3.0 * plastic / (dx * speed) >= kLeastExcess) return kLowerYield;
  return fmt::format("is consistency in {}? take it at least {:.2g} times as large",
                     parts_of(s.fluid.law.model).index ? "Pa sⁿ" : "Pa s",
                     1.01 * kLeastExcess * nu_of_tau(plan) / plastic);
}

/// A bound beyond the other one, which the law makes where the scene gives one of them.
/// @throws InputError
void check_order(const Scene& s, const ViscosityLaw& law) {
  if (law.nu_min() < law.nu_max()) return;
  const std::string both = fmt::format("{}: {} is not below {}", s.file,
                                       bound_text("nu_min", law.nu_min(), lower_default(s, law)),
                                       bound_text("nu_max", law.nu_max(), upper_default(s)));
  const char* larger = law.nu_min() < 0.01 * kThickest ? "take a larger nu_max; or " : "";
  throw InputError(both, !s.fluid.law.nu_min ? larger + way_to_thinner(s)
                                             : "take a smaller nu_min; or " +
                                                   way_to_thicker(s, law.nu_min() / law.nu_max()));
}

/// A viscosity at the typical shear rate that the step cannot carry; its bounds may be off with it.
/// @throws InputError
void check_typical(const Scene& s, const ViscosityLaw& law, const Plan& plan) {
  const double nu = law.reference(), tau = tau_of(plan, nu), dx = plan.units.dx;
  const std::string makes =
      fmt::format("{:.3g} m²/s at the typical shear rate, {:.3g} 1/s", nu, law.shear_rate());
  if (tau - 0.5 < kLeastExcess)
    throw InputError(fmt::format("{}: fluid.viscosity makes {}: τ - ½ = 3 ν Δt/Δx² = {:.2g} is too "
                                 "small for round-off",
                                 s.file, makes, tau - 0.5),
                     way_to_thicker(s, 1.01 * kLeastExcess / (tau - 0.5) *
                                           (s.fluid.law.nu_min ? 1.0 : nu / law.nu_min())));
  if (tau <= kStopTau) return;
  const double step = dx * dx / (3.0 * nu), steps = s.end_time / step;
  const std::string shorter =
      steps > kMostSteps
          ? ""
          : fmt::format("take at most {:.3g} s: {:.2g} steps, {}; or, if that is too long, ", step,
                        steps, run_time_text(s, plan, steps));
  throw InputError(s.file + ": numerics.time_step",
                   fmt::format("gives τ = {:.3g}, above {}, since fluid.viscosity makes {}: walls "
                               "and solids would be inexact",
                               tau, kStopTau, makes),
                   shorter + way_to_thinner(s));
}

/// A bound that the step cannot carry. @throws InputError
void refuse_bounds(const Scene& s, const ViscosityLaw& law, const Plan& plan,
                   const std::string& lower, const std::string& upper) {
  const double low = tau_of(plan, law.nu_min()), high = tau_of(plan, law.nu_max());
  const double rate = law.shear_rate(), a_tau = nu_of_tau(plan);
  if (high > kLargestTau)
    throw InputError(fmt::format("{}: {} has τ = {:.4g}, above {}: the stress there would follow "
                                 "the flow too slowly",
                                 s.file, upper, high, kLargestTau),
                     fmt::format("take at most {:.3g} m²/s, or a smaller numerics.time_step",
                                 (kLargestTau - 0.5) * a_tau));
  if (low - 0.5 >= kLeastExcess) return;
  const std::string text =
      fmt::format("{}: {} has τ - ½ = {:.2g}, too small for round-off", s.file, lower, low - 0.5);
  if (is_plastic(s, law))
    throw InputError(fmt::format("{}: yield_stress = {:.4g} Pa is {:.2g} times the viscous stress "
                                 "at the typical shear rate, {:.3g} 1/s",
                                 text, s.fluid.law.yield_stress,
                                 s.fluid.law.yield_stress / viscous_stress(s, rate), rate),
                     way_out_of_yield(s, plan, rate));
  const double wished = std::min((kLeastTau - 0.5) * a_tau, 0.1 * law.reference());
  const bool finer = finer_helps(plan) && kLeastExcess < kAFewCells * (low - 0.5);
  throw InputError(text, fmt::format("take fluid.viscosity.nu_min = {:.3g} m²/s or more{}",
                                     std::max(wished, 1.01 * kLeastExcess * a_tau),
                                     finer ? ", or a finer cell" : ""));
}

/// What to do where the flow of the thinnest fluid is not resolved.
std::string way_to_resolve(const Scene& s, const ViscosityLaw& law, const Plan& plan) {
  const double excess = tau_of(plan, law.reference()) - 0.5, least = kLeastTau - 0.5;
  if (excess < least)
    return way_to_larger_tau(plan.step_bound) +
           ("; or, if the fluid is not that thin, " + way_to_thicker(s, 1.01 * least / excess));
  const std::string finer = finer_helps(plan) ? "a finer cell, or " : "";
  // a larger nu_min would cut off what the fluid has without its yield stress
  if (yields(s) && law.nu_min() <= 1.001 * plastic_viscosity(s, law.shear_rate()))
    return "take " + finer +
           "the fluid.viscosity.shear_rate at which the fluid flows, or a lower yield_stress";
  return "take " + finer + "a larger nu_min";
}

void check_bounds(const Scene& s, const ViscosityLaw& law, Plan& plan) {
  const double low = tau_of(plan, law.nu_min()), high = tau_of(plan, law.nu_max());
  const std::string lower = bound_text("nu_min", law.nu_min(), lower_default(s, law)),
                    upper = bound_text("nu_max", law.nu_max(), upper_default(s));
  refuse_bounds(s, law, plan, lower, upper);
  if (high > kSlowTau)
    plan.warnings.push_back(fmt::format(
        "{} has τ = {:.3g}: parts that stiff answer a change of load only after some {:.2g} s; "
        "where that matters take a smaller nu_max or numerics.time_step",
        upper, high, high * plan.units.dt));
  if (low < kLeastTau)
    plan.warnings.push_back(
        fmt::format("{} has τ = {:.5g}: where the fluid is that thin the flow is not resolved; {}",
                    lower, low, way_to_resolve(s, law, plan)));
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

/// A yield stress that makes the run long, since the viscosity that it gives sets the step, or lets
/// it be no longer than the one that the scene gives. @return whether there is one
bool check_cost(const Scene& s, const ViscosityLaw& law, Plan& plan) {
  const StepChoice longest = choose_step(s, plan.units.dx, law.reference());
  if (longest.bound != StepBound::Relaxation) return false;
  const StepChoice alone = choose_step(s, plan.units.dx, plastic_viscosity(s, law.shear_rate()));
  const double steps = static_cast<double>(plan.intervals) * plan.fluid_steps,
               longer = std::min(plan.lattice_speed, longest.lattice_speed) / alone.lattice_speed;
  if (longer < kMuchLonger || run_seconds(s, plan, steps) < kLongRun) return false;
  plan.warnings.push_back(
      fmt::format("fluid.viscosity.yield_stress = {:.4g} Pa makes {:.3g} m²/s at the typical shear "
                  "rate, {:.3g} 1/s, which {}: the run takes {:.2g} steps, {:.2g} times as many as "
                  "without it, {}: {}",
                  s.fluid.law.yield_stress, law.reference(), law.shear_rate(),
                  plan.step_bound == StepBound::Given ? "allows no longer step" : "sets the step",
                  steps, longer, run_time_text(s, plan, steps), kLowerYield));
  return true;
}

/// A viscosity that no liquid has, and what it costs.
void check_thick(const Scene& s, const ViscosityLaw& law, Plan& plan) {
  if (law.reference() <= kThickest) return;
  const double steps = static_cast<double>(plan.intervals) * plan.fluid_steps;
  const std::string cost =
      run_seconds(s, plan, steps) < kLongRun
          ? ""
          : fmt::format("; the run takes {:.2g} steps, {}", steps, run_time_text(s, plan, steps));
  plan.warnings.push_back(fmt::format(
      "fluid.viscosity makes {:.3g} m²/s at the typical shear rate, {:.3g} 1/s, unusually large "
      "for a liquid (water: 1e-6, a paste: 1){}; {}",
      law.reference(), law.shear_rate(), cost, way_to_thinner(s)));
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
  if (const auto [part, text] = creep_of(s, law); std::abs(part) > kMuchCreep) {
    const bool slow = tau_of(plan, law.nu_max() * part / kMuchCreep) > kSlowTau;
    plan.warnings.push_back(
        "fluid.viscosity: " + text + "; take " +
        (part < 0.0 ? "a smaller nu_min"
         : slow     ? "a larger nu_max, and a numerics.time_step that is as much smaller"
                    : "a larger nu_max"));
  }
}

/// A bound that cuts off what flows beside the yield stress.
void check_yield(const Scene& s, const ViscosityLaw& law, Plan& plan) {
  if (!yields(s)) return;
  const double rate = law.shear_rate(), plastic = plastic_viscosity(s, rate);
  if (law.nu_min() <= 1.001 * plastic) return;
  plan.warnings.push_back(fmt::format(
      "{} is above what the fluid has without its yield stress at the typical shear rate, {:.4g} "
      "m²/s: where it flows it is thicker than its law; {}",
      bound_text("nu_min", law.nu_min(), lower_default(s, law)), plastic,
      tau_of(plan, plastic) - 0.5 < kLeastExcess
          ? fmt::format("its yield_stress = {:.4g} Pa is {:.2g} times the viscous stress: {}",
                        s.fluid.law.yield_stress,
                        s.fluid.law.yield_stress / viscous_stress(s, rate),
                        way_out_of_yield(s, plan, rate))
          : "give a nu_min below that"));
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
  check_order(s, law);
  check_typical(s, law, plan);
  if (!yields(s) || !check_cost(s, law, plan)) check_thick(s, law, plan);
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
