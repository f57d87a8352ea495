// SPDX-License-Identifier: GPL-2.0-or-later
#include "lbm_solver/solver/viscosity_plan.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "lbm_solver/base/errors.h"
#include "lbm_solver/viscosity/mean_law.h"
#include "lbm_solver/viscosity/relaxation_table.h"
#include "lbm_solver/viscosity/viscosity_law.h"

namespace lbm {
namespace {

constexpr double kLargestTau = 400.0;  // above, a step changes the stress by too little
constexpr double kSlowTau = 60.0;      // above, stiff parts answer slowly
constexpr double kLeastTau = 0.501;    // below, the noise of the stress decides
constexpr double kMovedPlug = 5.0;     // τ u/c_s above which TRT thins what moves without yielding

ViscosityLaw law_of(const Scene& s) {
  return {s.fluid, s.fluid.law.shear_rate.value_or(typical_shear_rate(s))};
}

bool yields(const Scene& s) {
  return s.fluid.law.yield_stress > 0.0;
}

double tau_of(const Plan& plan, double viscosity) {
  return 0.5 + 3.0 * viscosity * plan.units.dt / (plan.units.dx * plan.units.dx);
}

/// Shear rate at which the law comes to a bound [1/s]; 0: it never does.
double shear_rate_at(const ViscosityLaw& law, double bound, bool from_above) {
  for (double rate = 1e-9 * law.shear_rate(); rate < 1e9 * law.shear_rate(); rate *= 1.01)
    if (from_above ? law(rate) < 0.999 * bound : law(rate) <= 1.001 * bound) return rate;
  return 0.0;
}

void check_bounds(const Scene& s, const ViscosityLaw& law, Plan& plan) {
  const double low = tau_of(plan, law.nu_min()), high = tau_of(plan, law.nu_max());
  const double a_tau = plan.units.dx * plan.units.dx / (3.0 * plan.units.dt);
  if (law.nu_min() >= law.nu_max())
    throw InputError(
        s.file + ": fluid.viscosity",
        fmt::format("goes from nu_min = {:.4g} to nu_max = {:.4g} m²/s, which is no range",
                    law.nu_min(), law.nu_max()),
        "give nu_min < nu_max");
  if (high > kLargestTau)
    throw InputError(fmt::format("{}: fluid.viscosity.nu_max = {:.4g} m²/s has τ = {:.4g}, above "
                                 "{}: the stress there would follow "
                                 "the flow too slowly",
                                 s.file, law.nu_max(), high, kLargestTau),
                     fmt::format("take at most {:.3g} m²/s, or a smaller numerics.time_step",
                                 (kLargestTau - 0.5) * a_tau));
  if (low - 0.5 < 1e-6)
    throw InputError(fmt::format("{}: fluid.viscosity.nu_min = {:.4g} m²/s has τ - ½ = {:.2g}, too "
                                 "small for round-off",
                                 s.file, law.nu_min(), low - 0.5),
                     fmt::format("take at least {:.3g} m²/s, or a finer cell", 1e-3 * a_tau));
  if (high > kSlowTau)
    plan.warnings.push_back(
        fmt::format("fluid.viscosity.nu_max = {:.4g} m²/s has τ = {:.3g}: parts that stiff answer "
                    "a change of load "
                    "only after some {:.2g} s",
                    law.nu_max(), high, high * plan.units.dt));
  if (low < kLeastTau)
    plan.warnings.push_back(fmt::format(
        "fluid.viscosity.nu_min = {:.4g} m²/s has τ = {:.5g}: where the fluid is that thin "
        "the flow is not resolved; take a finer cell, or a larger nu_min",
        law.nu_min(), low));
  const double rate = law.shear_rate(), typical = law(rate);
  for (const double bound : {law.nu_min(), law.nu_max()})
    if (std::abs(typical / bound - 1.0) < 1e-3)
      plan.warnings.push_back(
          fmt::format("at the typical shear rate, {:.3g} 1/s, the viscosity is at its bound {:.4g} "
                      "m²/s: the law does "
                      "not act; give another bound or fluid.viscosity.shear_rate",
                      rate, bound));
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
  check_bounds(s, law, plan);
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
  if (parts.consistency) text += fmt::format(", K {:.4g} Pa sⁿ", v.consistency);
  if (parts.index) text += fmt::format(", n {:.4g}", v.index);
  if (yields(s))
    text += fmt::format(", σ_y {:.4g} Pa ({})", v.yield_stress,
                        v.regularisation == ViscosityScene::Regularisation::Papanastasiou
                            ? "Papanastasiou"
                            : "bi-viscosity");
  if (parts.time_constant) text += fmt::format(", λ {:.4g} s", v.time_constant);
  lines.push_back(text +
                  fmt::format("; ν {:.4g} m²/s at the typical shear rate {:.4g} 1/s", nu, rate));
  const double slow = shear_rate_at(law, law.nu_max(), true),
               fast = shear_rate_at(law, law.nu_min(), false);
  lines.push_back(fmt::format(
      "ν {:.4g} … {:.4g} m²/s, τ {:.5g} … {:.4g}; the law acts from {:.3g} to {} 1/s", law.nu_min(),
      law.nu_max(), tau_of(plan, law.nu_min()), tau_of(plan, law.nu_max()), slow,
      fast > 0.0 ? fmt::format("{:.3g}", fast) : "any number of"));
  const double length = s.fluid.velocity_scale / rate;
  if (yields(s))
    lines.push_back(
        fmt::format("Bingham number {:.3g}, yield stress over viscous stress at {:.3g} 1/s; Re "
                    "{:.3g} over {:.3g} m",
                    v.yield_stress / (v.consistency * std::pow(rate, v.index)), rate,
                    s.fluid.velocity_scale * length / nu, length));
  else
    lines.push_back(fmt::format("Re {:.3g} with ν at {:.3g} 1/s over {:.3g} m",
                                s.fluid.velocity_scale * length / nu, rate, length));
  return lines;
}

}  // namespace lbm
