// SPDX-License-Identifier: GPL-2.0-or-later
#include "lbm_solver/solver/scene_check.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "lbm_solver/base/errors.h"
#include "lbm_solver/boundary/patch.h"
#include "lbm_solver/immersed/geometry.h"
#include "lbm_solver/immersed/solid_term.h"
#include "lbm_solver/solver/driven_speed.h"
#include "lbm_solver/solver/motion_check.h"
#include "lbm_solver/solver/place_check.h"

namespace lbm {
namespace {

constexpr double kDeepRest = 0.05, kDeepHit = 1.0;  // overlap over radius that goes unremarked
constexpr double kManyBytes = 20e9;                 // of fields
constexpr double kThick = 0.1;                      // m²/s: more than any honey
constexpr double kMuchFaster = 30.0;    // than velocity_scale: grains resist, estimates are rough
constexpr double kLargeGrain = 0.2;     // m, in a coupled scene
constexpr double kLargeReynolds = 1e5;  // of a cell
constexpr double kThinObstacle = 4.0;   // cells
constexpr double kStepsAPeriod = 20.0;  // of an oscillation
constexpr double kTightLayer = 3.0;     // cells

/// Largest speed that the scene itself gives [m/s], and to what.
std::pair<double, std::string> given_speed(const Scene& s) {
  const bool layers = s.initial.kind == InitialScene::Kind::ShearLayer;  // a wave lies across
  const double across = layers ? s.initial.perturbation : 0.0;
  std::pair<double, std::string> largest{s.initial.velocity.norm() * std::hypot(1.0, across),
                                         "initial.velocity"};
  const auto look = [&](double speed, const std::string& what) {
    if (speed > largest.first) largest = {speed, what};
  };
  for (const BoundaryScene& b : s.boundaries) {
    look(b.velocity.norm() * b.table.largest() * b.profile.largest(), "boundary.velocity");
    look(opening_speed(s, b), "boundary.flow_rate");
  }
  for (const ObstacleScene& o : s.obstacles) {
    look(0.5 * o.diameter * o.spin.norm(), "an obstacle's spin");
    if (o.motion) look(largest_speed(*o.motion, reach_of(o), s.end_time), "an obstacle's motion");
  }
  look(mean_speed(s), "fluid.flow_rate");
  return largest;
}

void check_speed(const Scene& s, Plan& plan) {
  const auto [speed, what] = given_speed(s);
  if (speed > kStopSpeed * plan.lattice_speed)
    throw InputError(
        fmt::format("{}: {} makes {:.4g} m/s, {:.3g} of C = Δx/Δt; a run stops at {}", s.file, what,
                    speed, speed / plan.lattice_speed, kStopSpeed),
        fmt::format("take velocity_scale = {:.4g}, the largest speed to expect", speed));
  if (speed > 1.001 * s.fluid.velocity_scale && speed > kWarnSpeed * plan.lattice_speed)
    plan.warnings.push_back(
        fmt::format("{} makes {:.4g} m/s, more than velocity_scale = {:.4g}: compressibility error",
                    what, speed, s.fluid.velocity_scale));
}

/// Mean factor of a velocity over a boundary.
double mean_factor(const Scene& s, const BoundaryScene& b) {
  if (b.parabolic) return std::pow(2.0 / 3.0, s.box.dimension - 1);
  if (b.profile.factors.empty()) return 1.0;
  constexpr int parts = 200;  // along each axis
  const SideProfile profile{b.profile.places, b.profile.factors};
  double sum = 0.0;
  for (int i = 0; i < parts * parts; ++i) {
    std::array<double, 2> at{};
    for (int k = 0; k < s.box.dimension - 1; ++k) {
      const Range part = extent(s, b, k);
      const int number = k == 0 ? i % parts : i / parts;
      at[k] = part.lo + (number + 0.5) / parts * (part.hi - part.lo);
    }
    sum += profile.factor(at);
  }
  return sum / (parts * parts);
}

/// What the velocity boundaries bring in, less what they take out, over the sum of both.
double surplus(const Scene& s) {
  double sum = 0.0, all = 0.0;
  for (const BoundaryScene& b : s.boundaries) {
    double flow = b.velocity[axis_of(b.side)] * (is_high(b.side) ? -1.0 : 1.0);
    for (int k = 0; k < s.box.dimension - 1; ++k) {
      const Range part = extent(s, b, k);
      flow *= part.hi - part.lo;
    }
    flow *= mean_factor(s, b);
    sum += flow;
    all += std::abs(flow);
  }
  return all > 0.0 ? sum / all : 0.0;
}

void check_balance(const Scene& s, Plan& plan) {
  for (const BoundaryScene& b : s.boundaries)
    if (b.kind != BoundaryScene::Kind::Velocity || b.frequency > 0.0 || !b.table.times.empty())
      return;
  if (const double more = surplus(s); std::abs(more) > 1e-3)
    plan.warnings.push_back(
        fmt::format("fluid {} through its boundaries and nothing makes up for it: the pressure {} "
                    "without end; add a boundary of kind \"outflow\" or \"pressure\"",
                    more > 0.0 ? "enters" : "leaves", more > 0.0 ? "rises" : "falls"));
}

/// Drives that would make the fluid much faster than the scene says. Velocities have their own
/// check.
void check_drives(const Scene& s, Plan& plan) {
  for (const Drive& drive : drives(s))
    if (drive.speed > kMuchFaster * s.fluid.velocity_scale)
      plan.warnings.push_back(fmt::format(
          "{} can give {:.2g} m/s, {:.2g} times fluid.velocity_scale: are its value and "
          "unit right?",
          drive.what, drive.speed, drive.speed / s.fluid.velocity_scale));
}

/// An oscillation that a step or a run does not resolve.
void check_frequency(const Scene& s, double frequency, const std::string& what, Plan& plan) {
  if (frequency == 0.0) return;
  if (const double steps = 1.0 / (frequency * plan.units.dt); steps < kStepsAPeriod)
    throw InputError(
        fmt::format("{}: {} = {:.4g} Hz has {:.3g} fluid steps a period", s.file, what, frequency,
                    steps),
        fmt::format("take at least {:.0f}: a lower frequency or a smaller numerics.time_step",
                    kStepsAPeriod));
  if (frequency * s.end_time < 1.0)
    plan.warnings.push_back(fmt::format("{} = {:.4g} Hz: the run ends after {:.3g} of a period",
                                        what, frequency, frequency * s.end_time));
}

void check_frequencies(const Scene& s, Plan& plan) {
  for (const BoundaryScene& b : s.boundaries)
    check_frequency(s, b.frequency, "boundary.frequency", plan);
  for (const ObstacleScene& o : s.obstacles)
    if (o.motion) check_frequency(s, o.motion->frequency, "obstacle.frequency", plan);
  check_frequency(s, s.fluid.body_force_frequency, "fluid.body_force_frequency", plan);
  const bool varies = s.fluid.body_force_frequency > 0.0 || !s.fluid.body_force_table.times.empty();
  if (varies && s.coupling && s.coupling->carry_weight)
    throw InputError(s.file + ": coupling.carry_weight",
                     "would change in time with the body force, and the particles' weight does not",
                     "leave it out, or take a steady body force");
}

/// Keys that have no effect in this scene.
void check_idle_keys(const Scene& s, Plan& plan) {
  if (s.output.viscosity && !plan.kernel.local_viscosity())
    plan.warnings.push_back("output.viscosity writes a viscosity that is the same everywhere");
  if (s.fluid.body_force_ramp > s.end_time)
    plan.warnings.push_back(
        fmt::format("fluid.body_force_ramp = {:.4g} s is longer than the run: the force reaches "
                    "{:.3g} of its value",
                    s.fluid.body_force_ramp,
                    InTime{s.fluid.body_force_ramp / plan.units.dt, 0.0}.factor(
                        static_cast<std::int64_t>(s.end_time / plan.units.dt))));
  if (s.numerics.weight != "auto" && by_resistance(plan.kernel.solid_term))
    plan.warnings.push_back(fmt::format("numerics.weight = \"{}\" has no effect: {} has no weight",
                                        s.numerics.weight, plan.kernel.solid_term));
}

/// A body force of its own carries the particles' weight along an axis.
bool carried(const Scene& s, int axis) {
  return (s.coupling && s.coupling->carry_weight) || (s.fluid.flow && s.fluid.flow->axis == axis);
}

/// Gravity that points upwards, or that nothing holds.
void check_gravity(const Scene& s, Plan& plan) {
  const int up = s.box.dimension - 1;
  const Vec3& g = s.fluid.gravity;
  if (g[up] > 0.0)
    plan.warnings.push_back(
        fmt::format("fluid.gravity points upwards (+{}): is its sign right?", "xyz"[up]));
  const bool neutral =
      s.particles->density.lo == s.fluid.density && s.particles->density.hi == s.fluid.density;
  for (int k = 0; k < s.box.dimension && !neutral; ++k)
    if (g[k] != 0.0 && s.box.sides[k] == SideKind::Periodic && s.fluid.body_force[k] == 0.0 &&
        !carried(s, k) && s.box.pressure_jump[k] == 0.0)
      plan.warnings.push_back(
          fmt::format("fluid.gravity acts along {0}, where the box is periodic and nothing holds "
                      "the particles: they take the fluid along, faster and faster; take "
                      "sides_{0} = \"wall\", or a fluid.body_force that carries their weight",
                      "xyz"[k]));
}

/// Lengths that look like millimetres taken for metres, cells too coarse for anything.
void check_sizes(const Scene& s, Plan& plan) {
  if (s.coupling && s.particles->diameter.lo > kLargeGrain)
    plan.warnings.push_back(
        fmt::format("particles.diameter = {:.3g} m: lengths are in metres, is that meant?",
                    s.particles->diameter.lo));
  if (plan.reynolds_cell > kLargeReynolds)
    plan.warnings.push_back(
        fmt::format("Re_h = velocity_scale × cell / viscosity = {:.2g}: a cell sees a turbulent "
                    "flow of its own; are lengths in metres and the viscosity in m²/s?",
                    plan.reynolds_cell));
  for (const ObstacleScene& o : s.obstacles) {
    if (const double cells = o.mesh ? o.mesh->thickness / plan.units.dx : 0.0;
        cells > 0.0 && cells < kTightLayer)
      plan.warnings.push_back(fmt::format(
          "obstacle.thickness = {:.4g} m is {:.3g} cells: fluid seeps through a layer of "
          "less than {}, where no cell is covered whole",
          o.mesh->thickness, cells, kTightLayer));
    double width = o.diameter;
    if (o.block()) width = (o.to - o.from).head(s.box.dimension).minCoeff();
    if (o.grain || o.hollow || !o.round || width >= kThinObstacle * plan.units.dx) continue;
    plan.warnings.push_back(
        fmt::format("the obstacle at {} is {:.2g} cells wide: the flow past it is not resolved; "
                    "take a finer cell",
                    place_text(s, o.centre), width / plan.units.dx));
  }
}

/// Obstacles that lie in each other.
void check_overlaps(const Scene& s, Plan& plan) {
  for (std::size_t i = 0; i < s.obstacles.size(); ++i)
    for (std::size_t j = 0; j < i; ++j) {
      const ObstacleScene &a = s.obstacles[j], &b = s.obstacles[i];
      if (a.grain || b.grain || a.hollow || b.hollow || !b.round) continue;
      if (depth_in(s, a, b.centre, 0.5 * b.diameter) <= kTouch) continue;
      plan.warnings.push_back(
          fmt::format("the {}. obstacle lies partly in the {}.: the load on "
                      "cells that both cover is shared between them",
                      i + 1, j + 1));
    }
}

void check_viscosity(const Scene& s, Plan& plan) {
  if (s.fluid.viscosity > kThick)
    plan.warnings.push_back(fmt::format(
        "fluid.kinematic_viscosity = {:.3g} m²/s is unusually large for a liquid (water: 1e-6); "
        "kinematic viscosity is in m²/s",
        s.fluid.viscosity));
}

void check_contacts(const Scene& s, Plan& plan) {
  const ParticleScene& p = *s.particles;
  if (!p.contact_stiffness) return;
  const double r = 0.5 * p.diameter.hi, volume = particle_volume(s, p.diameter.hi);
  const double weight =
      std::max(0.0, p.density.hi - s.fluid.density) * volume * s.fluid.gravity.norm();
  // In parts of the radius: of one particle on another, and where one comes with velocity_scale.
  const double resting = weight / *p.contact_stiffness / r;
  const double hitting =
      s.fluid.velocity_scale * std::sqrt(p.density.hi * volume / *p.contact_stiffness) / r;
  if (resting > kDeepRest)
    plan.warnings.push_back(
        fmt::format("particles.contact_stiffness is soft: under its weight alone a particle sinks "
                    "into another by {:.3g} of its radius; {:.2g} N/m would keep that to {}",
                    resting, *p.contact_stiffness * resting / kDeepRest, kDeepRest));
  else if (hitting > kDeepHit)
    plan.warnings.push_back(
        fmt::format("particles.contact_stiffness is soft: a particle with velocity_scale goes "
                    "through another ({:.3g} of its radius); {:.2g} N/m would stop it at {}",
                    hitting, *p.contact_stiffness * hitting * hitting, kDeepHit));
}

void check_output(const Scene& s, Plan& plan) {
  if (s.output.fields_every == 0.0) return;
  const double frames = s.end_time / std::max(s.output.fields_every, plan.interval());
  constexpr double numbers = 5.0;  // velocity, pressure, solid fraction
  const double cells = static_cast<double>(plan.domain.nx) * plan.domain.ny * plan.domain.nz;
  if (const double bytes = frames * cells * numbers * sizeof(float); bytes > kManyBytes)
    plan.warnings.push_back(
        fmt::format("output.fields_every = {:.3g} s writes {:.3g} frames, {:.3g} GB before packing",
                    s.output.fields_every, frames, 1e-9 * bytes));
}

/// Particles that the scene starts with their centres in a mesh or an image.
void check_starts_in_shapes(const Scene& s, const Plan& plan) {
  if (!s.particles || s.particles->start.empty()) return;
  for (const Geometry& shape : obstacle_shapes(s, plan))
    for (const Vec3& x : s.particles->start) {
      const Vec3 at = plan.units.to_lattice_position(x);
      Block cell = Block::whole(plan.domain);
      for (int k = 0; k < 3; ++k) {
        cell.begin[k] = std::clamp(static_cast<int>(at[k]), 0, plan.domain.cells()[k] - 1);
        cell.size[k] = 1;
      }
      double fraction = 0.0;
      fill(shape, plan.domain, cell, {},
           [&](const FractionSpan& span) { fraction += span.fractions.front(); });
      if (fraction > 0.5)
        throw InputError(s.file + ": particles.start",
                         place_text(s, x) + " lies in an obstacle's mesh or image",
                         "move the particle or the obstacle");
    }
}

}  // namespace

void check_meaning(const Scene& s, Plan& plan) {
  check_speed(s, plan);
  check_balance(s, plan);
  check_drives(s, plan);
  check_sizes(s, plan);
  check_frequencies(s, plan);
  check_motions(s, plan);
  check_idle_keys(s, plan);
  check_overlaps(s, plan);
  check_starts_in_shapes(s, plan);
  if (s.coupling) check_gravity(s, plan);
  if (s.coupling) check_viscosity(s, plan);
  if (s.coupling) check_contacts(s, plan);
  check_output(s, plan);
}

}  // namespace lbm
