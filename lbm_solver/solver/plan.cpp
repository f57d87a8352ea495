// SPDX-License-Identifier: GPL-2.0-or-later
#include "lbm_solver/solver/plan.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "lbm_solver/base/errors.h"
#include "lbm_solver/immersed/resistance.h"
#include "lbm_solver/solver/driven_speed.h"
#include "lbm_solver/solver/expected_error.h"
#include "lbm_solver/solver/place_check.h"
#include "lbm_solver/solver/scene_check.h"
#include "lbm_solver/solver/viscosity_advice.h"
#include "lbm_solver/solver/viscosity_plan.h"

namespace lbm {
namespace {

constexpr double kStepFractionOfContact = 0.1;  // solid step / √(m/k): the papers' λ
constexpr double kLimitReynoldsCell = 5.0;      // beyond: fixed-Λ TRT gives noisy forces
constexpr double kDensityChange = 0.03;         // that a pressure difference may cause
constexpr double kLeastMagic = 0.05, kLargestMagic = 0.375;  // where resistance is positive
constexpr double kFewCells = 4.0;  // a diameter below which nothing is claimed

double cell_size(const Scene& s) {
  if (s.numerics.cell) return *s.numerics.cell;
  if (!s.particles)
    throw InputError(s.file + ": numerics.cells_per_diameter", "needs a table [particles]",
                     "give numerics.cell instead");
  return s.particles->diameter.lo / *s.numerics.cells_per_diameter;
}

int cells_along(const Scene& s, double length, double dx, const char* axis) {
  const double cells = length / dx;
  const double whole = std::round(cells);
  if (std::abs(cells - whole) > 1e-6 * cells || whole < 3.0)
    throw InputError(
        s.file + ": box.size",
        fmt::format(
            "{} = {:.9g} m holds {:.6g} cells of {:.6g} m, not a whole number of at least 3", axis,
            length, cells, dx),
        fmt::format("take {:.9g} m, or another cell", std::max(3.0, whole) * dx));
  if (whole > 100000.0)
    throw InputError(s.file + ": numerics", fmt::format("{:.3g} cells along {}", whole, axis),
                     "take a coarser cell");
  return static_cast<int>(whole);
}

Side to_side(SideKind kind) {
  return kind == SideKind::Wall ? Side::Wall : Side::Periodic;
}

/// The Reynolds number of all messages and summaries, and its length.
void count_reynolds(const Scene& s, Plan& plan) {
  plan.reynolds_length = s.box.size.x();
  plan.reynolds_of = "the box along x";
  bool walls = false;  // a channel's length is no length of its flow
  for (int k = 0; k < s.box.dimension; ++k) {
    if (s.box.sides[k] != SideKind::Wall || (walls && s.box.size[k] >= plan.reynolds_length))
      continue;
    walls = true;
    plan.reynolds_length = s.box.size[k];
    plan.reynolds_of = fmt::format("the gap between the walls along {}", "xyz"[k]);
  }
  const auto round = std::ranges::find_if(s.obstacles, &ObstacleScene::round);
  if (s.particles) {
    plan.reynolds_length = s.particles->diameter.lo;
    plan.reynolds_of = "the smallest particle";
  } else if (round != s.obstacles.end()) {
    plan.reynolds_length = round->diameter;
    plan.reynolds_of = "the first round obstacle";
  }
  plan.reynolds = s.fluid.velocity_scale * plan.reynolds_length / s.fluid.viscosity;
}

void take_step(const Scene& s, Plan& plan) {
  if (s.numerics.time_step) {
    plan.lattice_speed = plan.units.dx / *s.numerics.time_step;
    plan.step_limit = "given by the scene";
    return;
  }
  const StepChoice choice = choose_step(s, plan.units.dx, s.fluid.viscosity);
  plan.lattice_speed = choice.lattice_speed;
  plan.step_bound = choice.bound;
  plan.step_limit = choice.words;
}

/// Rounds the step down so that the end time is a whole number of intervals. A run that goes on has
/// its step already: rounded to another end time it would be another one, and the states of the
/// checkpoint, in lattice units, would mean another flow. It ends with the interval that reaches
/// the end time.
void fit_to_end(const Scene& s, std::optional<double> given, Plan& plan) {
  plan.wished_step = plan.units.dx / plan.lattice_speed;
  const double wished = given.value_or(plan.wished_step);
  const double whole = s.end_time / (wished * plan.fluid_steps);
  const double intervals = std::ceil(whole * (1.0 - 1e-12) - 1e-9);
  if (intervals > kMostSteps)
    throw InputError(s.file + ": run.end_time",
                     fmt::format("needs {:.2g} steps [{}]", intervals, plan.step_limit),
                     way_to_fewer_steps(s, plan, intervals / kMostSteps));
  plan.intervals = std::max<std::int64_t>(1, static_cast<std::int64_t>(intervals));
  plan.units.dt = s.numerics.time_step || given
                      ? wished
                      : s.end_time / (static_cast<double>(plan.intervals) * plan.fluid_steps);
  plan.lattice_speed = plan.units.dx / plan.units.dt;
}

/// @throws InputError  no fluid can be computed with this step
void check_step(const Scene& s, const Plan& plan) {
  const double tau = plan.kernel.parameters.tau;
  if (plan.u_over_c > kStopSpeed)
    throw InputError(
        s.file + ": numerics.time_step",
        fmt::format("gives velocity_scale/C = {:.3g}, above {} (compressible)", plan.u_over_c,
                    kStopSpeed),
        fmt::format("take at most {:.3g} s", kWarnSpeed * plan.units.dx / s.fluid.velocity_scale));
  if (tau - 0.5 < kLeastExcess)
    throw InputError(
        s.file + ": numerics",
        fmt::format("τ - ½ = 3 ν Δt/Δx² = {:.2g} is too small for round-off", tau - 0.5),
        way_to_larger_tau(plan.step_bound));
  if (tau > kStopTau)
    throw InputError(
        s.file + ": numerics.time_step",
        fmt::format("gives τ = {:.3g}, above {}: walls and solids would be inexact", tau, kStopTau),
        fmt::format("take at most {:.3g} s",
                    plan.units.dx * plan.units.dx / (3.0 * s.fluid.viscosity)));
}

void judge_step(const Scene& s, Plan& plan) {
  plan.u_over_c = s.fluid.velocity_scale / plan.lattice_speed;
  check_step(s, plan);
  if (plan.u_over_c > kWarnSpeed * 1.001)
    plan.warnings.push_back(fmt::format(
        "velocity_scale/C = {:.3g} exceeds {}: compressibility error", plan.u_over_c, kWarnSpeed));
  const bool has_solids = s.coupling || !s.obstacles.empty();
  const bool fixed_magic = plan.kernel.collision == CollisionOperator::Trt ||
                           plan.kernel.collision == CollisionOperator::Bgk;
  if (plan.reynolds_cell > kLimitReynoldsCell && fixed_magic && has_solids)
    plan.warnings.push_back(
        fmt::format("Re_h = {:.3g} exceeds {}: forces are noisy with {}; take collision = \"auto\" "
                    "or a finer cell",
                    plan.reynolds_cell, kLimitReynoldsCell, name_of(plan.kernel.collision)));
  if (s.coupling && s.particles->density.lo < 0.9 * s.fluid.density &&
      plan.reynolds_cell > kLimitReynoldsCell)
    plan.warnings.push_back(
        "particles lighter than the fluid were proven stable up to Re_h = 5 only; watch their "
        "forces");
  if (plan.kernel.collision == CollisionOperator::Trt && plan.kernel.parameters.smagorinsky > 0.0)
    plan.warnings.push_back(
        "TRT with a turbulence model: its slow odd rate adds to the eddy viscosity where u ∇u is "
        "large; "
        "take collision = \"auto\"");
  if (plan.cells_per_diameter > 0.0 && plan.cells_per_diameter < kFewCells)
    plan.warnings.push_back(fmt::format("D/Δx = {:.3g} is below {}: no accuracy is claimed",
                                        plan.cells_per_diameter, kFewCells));
}

/// A scheme that the scene names, on links or markers.
void take_scheme(const Scene& s, Plan& plan) {
  const NumericsScene& n = s.numerics;
  const bool shapes = std::ranges::any_of(
      s.obstacles, [](const ObstacleScene& o) { return o.mesh || o.image || o.drum(); });
  if (shapes)
    throw InputError(fmt::format("{}: numerics.scheme = \"{}\" knows discs, spheres and blocks "
                                 "at rest, no meshes and images",
                                 s.file, name_of(*n.scheme)),
                     "take scheme = \"immersed_moving_boundary\"");
  if (n.solid_term)
    throw InputError(s.file + ": numerics.solid_term", "belongs to another scheme",
                     "leave it out, or take scheme = \"immersed_moving_boundary\"");
  plan.scheme = *n.scheme;
  const bool links =
      plan.scheme == SolidScheme::BounceBack || plan.scheme == SolidScheme::InterpolatedBounceBack;
  if (s.box.dimension == 3 && !links)
    throw InputError(fmt::format("{}: numerics.scheme = \"{}\" is there in two dimensions only",
                                 s.file, name_of(*n.scheme)),
                     "take immersed_moving_boundary, bounce_back or interpolated_bounce_back");
  // walls are covered cells under any scheme
  if (std::ranges::any_of(s.obstacles, [](const ObstacleScene& o) { return o.block(); }))
    plan.kernel.solid_term = SolidTerm::NobleTorczynski;
}

/// The solid collision operator of covered cells, where the scene leaves it open.
void choose_solid_term(const Scene& s, Plan& plan) {
  const auto take = [&](SolidTerm term, const char* reason) {
    plan.kernel.solid_term = term;
    plan.solid_reason = std::string("auto: ") + reason;
  };
  const bool moving = std::ranges::any_of(
      s.obstacles, [](const ObstacleScene& o) { return o.motion || !o.spin.isZero(0.0); });
  if (plan.kernel.collision != CollisionOperator::Trt)
    take(SolidTerm::LayeredNobleTorczynski, "least noise where the fluid is under-resolved");
  else if (s.coupling || moving)
    take(SolidTerm::LayeredResistance, "exact on planes at every τ, and calm in bodies that move");
  else
    take(SolidTerm::Resistance, "exact on planes at every τ");
}

void choose_solids(const Scene& s, Plan& plan) {
  const NumericsScene& n = s.numerics;
  KernelChoice& k = plan.kernel;
  k.solid_term = SolidTerm::None;
  if (!s.coupling && s.obstacles.empty()) return;
  if (n.scheme && *n.scheme != plan.scheme) return take_scheme(s, plan);
  k.weight = n.weight.value_or(s.box.dimension == 3 ? WeightRule::Balanced : WeightRule::Viscous);
  if (!n.solid_term) return choose_solid_term(s, plan);
  k.solid_term = *n.solid_term;
  if (by_resistance(k.solid_term) && k.collision != CollisionOperator::Trt)
    throw InputError(fmt::format("{}: numerics.solid_term = \"{}\" works with collision = \"trt\" "
                                 "only, which here is {}",
                                 s.file, name_of(k.solid_term), name_of(k.collision)),
                     "take collision = \"trt\", or solid_term = \"auto\"");
}

/// Λ of TRT: 3/16 puts a half-way wall half-way; beside covered cells by resistance 1/10.
double choose_magic(const Scene& s, const KernelChoice& k) {
  if (!by_resistance(k.solid_term)) return s.numerics.magic.value_or(kHalfWayMagic);
  const double magic = s.numerics.magic.value_or(kResistanceMagic);
  if (magic < kLeastMagic || magic > kLargestMagic)
    throw InputError(
        fmt::format(
            "{}: numerics.magic = {:.6g} is out of the range {} … {} in which covered cells "
            "by resistance are stable",
            s.file, magic, kLeastMagic, kLargestMagic),
        "leave it out (0.1), or take another numerics.solid_term");
  return magic;
}

void choose_kernel(const Scene& s, Plan& plan) {
  const NumericsScene& n = s.numerics;
  const double dx = plan.units.dx, dt = plan.units.dt;
  plan.reynolds_cell = s.fluid.velocity_scale * dx / s.fluid.viscosity;
  const bool calm = plan.reynolds_cell <= kLimitReynoldsCell, les = n.smagorinsky > 0.0;
  KernelChoice& k = plan.kernel;
  if (n.collision) {
    k.collision = *n.collision;
  } else {
    k.collision = calm && !les ? CollisionOperator::Trt : CollisionOperator::CentralMoment;
    plan.collision_reason =
        les ? "auto: the slow odd rate of TRT would disturb the turbulence model"
            : fmt::format(
                  "auto: Re_h = {:.3g} is {} {}, where {}", plan.reynolds_cell,
                  calm ? "at most" : "above", kLimitReynoldsCell,
                  calm ? "TRT is most accurate" : "TRT with fixed Λ gets noisy or unstable");
  }
  k.lattice = n.lattice.value_or(s.box.dimension == 2 ? VelocitySet::D2Q9 : VelocitySet::D3Q19);
  k.precision = n.precision;
  if (n.precision == Precision::Single && k.collision == CollisionOperator::RecursiveRegularised)
    throw InputError(
        s.file +
            ": numerics.collision = \"recursive_regularised\" is there in double precision only",
        "take central_moment, or precision = \"double\"");
  k.force =
      s.fluid.body_force.norm() > 0.0 || s.fluid.flow || (s.coupling && s.coupling->carry_weight);
  k.eddies = n.eddies;
  choose_solids(s, plan);
  const Vec3 force = s.fluid.body_force * (dt * dt / dx);
  k.parameters = {.tau = 0.5 + 3.0 * s.fluid.viscosity * dt / (dx * dx),
                  .magic = choose_magic(s, k),
                  .smagorinsky = n.smagorinsky,
                  .force_x = force.x(),
                  .force_y = force.y(),
                  .force_z = force.z()};
}

void choose_substeps(const Scene& s, Plan& plan) {
  const CouplingScene& c = *s.coupling;
  const ParticleScene& p = *s.particles;
  double needed = 1.0;
  if (p.contact_stiffness) {
    const double mass = particle_volume(s, p.diameter.lo) * p.density.lo;
    const double contact = std::sqrt(mass / *p.contact_stiffness);
    needed = std::ceil(plan.interval() / (kStepFractionOfContact * contact) - 1e-9);
    plan.substep_limit = fmt::format("contact: step ≤ {} √(m/k) = {:.3g} s", kStepFractionOfContact,
                                     kStepFractionOfContact * contact);
  } else {
    plan.substep_limit = "no contact_stiffness given";
  }
  if (constexpr double most = 1e6; !(needed <= most))
    throw InputError(
        fmt::format("{}: particles.contact_stiffness = {:.4g} N/m", s.file, *p.contact_stiffness),
        fmt::format("needs {:.3g} solid steps a coupling interval of {:.4g} s, more than {:.0e}",
                    needed, plan.interval(), most),
        "take softer contacts: some 1e5 N/m keep grains of millimetres apart");
  plan.substeps = c.substeps.value_or(static_cast<int>(std::max(1.0, needed)));
  if (c.substeps) plan.substep_limit = "given by the scene; " + plan.substep_limit;
  // 5 times the recommended step is 0.5 √(m/k), a quarter of the stability limit 2 √(m/k)
  if (plan.substeps * 5.0 < needed)
    throw InputError(
        fmt::format("{}: coupling.substeps = {} makes the solid's step too long for its contacts",
                    s.file, plan.substeps),
        fmt::format("take at least {:.0f} ({})", needed, plan.substep_limit));
}

}  // namespace

double particle_volume(const Scene& s, double diameter) {
  const double r = 0.5 * diameter;
  return s.box.dimension == 2 ? std::numbers::pi * r * r * s.box.depth
                              : 4.0 / 3.0 * std::numbers::pi * r * r * r;
}

StepChoice choose_step(const Scene& s, double dx, double nu) {
  const StepChoice limits[] = {
      {10.0 * s.fluid.velocity_scale, StepBound::Speed, "Mach: C = 10 × velocity_scale"},
      {3.0 * nu / dx, StepBound::Relaxation, "relaxation time: C = 3 ν/Δx keeps τ ≤ 1.5"},
      {std::sqrt(3.0 * largest_pressure(s) / (s.fluid.density * kDensityChange)),
       StepBound::Pressure, "compressibility: C = √(3 Δp/(ρ 0.03))"}};
  return *std::ranges::max_element(limits, {}, &StepChoice::lattice_speed);
}

Plan make_plan(const Scene& s, std::optional<double> step) {
  Plan plan;
  check_places(s);
  const double dx = cell_size(s);
  const bool solid = s.box.dimension == 3;
  plan.domain = {cells_along(s, s.box.size.x(), dx, "x"),
                 cells_along(s, s.box.size.y(), dx, "y"),
                 to_side(s.box.sides[0]),
                 to_side(s.box.sides[1]),
                 solid ? cells_along(s, s.box.size.z(), dx, "z") : 1,
                 solid ? to_side(s.box.sides[2]) : Side::Periodic};
  plan.units = {dx, 0.0, s.fluid.density, solid ? dx : s.box.depth, s.box.origin};
  count_reynolds(s, plan);
  if (s.particles) plan.cells_per_diameter = s.particles->diameter.lo / dx;
  if (s.coupling) plan.fluid_steps = s.coupling->fluid_steps;
  take_step(s, plan);
  fit_to_end(s, step, plan);
  choose_kernel(s, plan);
  plan_viscosity(s, plan);
  judge_step(s, plan);
  expect_error(s, plan);
  if (s.coupling) choose_substeps(s, plan);
  check_meaning(s, plan);
  return plan;
}

}  // namespace lbm
