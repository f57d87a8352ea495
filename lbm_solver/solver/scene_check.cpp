// SPDX-License-Identifier: GPL-2.0-or-later
#include "lbm_solver/solver/scene_check.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "lbm_solver/base/errors.h"
#include "lbm_solver/boundary/patch.h"
#include "lbm_solver/immersed/geometry.h"
#include "lbm_solver/immersed/solid_term.h"
#include "lbm_solver/solver/coupled_check.h"
#include "lbm_solver/solver/drive_check.h"
#include "lbm_solver/solver/driven_speed.h"
#include "lbm_solver/solver/few.h"
#include "lbm_solver/solver/motion_check.h"
#include "lbm_solver/solver/overlap_check.h"
#include "lbm_solver/solver/place_check.h"
#include "lbm_solver/solver/shape_check.h"
#include "lbm_solver/solver/table_check.h"

namespace lbm {
namespace {

constexpr double kManyBytes = 20e9;     // of fields
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
  for (std::size_t i = 0; i < s.obstacles.size(); ++i) {
    const ObstacleScene& o = s.obstacles[i];
    look(0.5 * o.diameter * o.spin.norm(), fmt::format("the {}. obstacle's spin", i + 1));
    if (!o.motion) continue;
    look(largest_speed(*o.motion, reach_of(o), s.end_time),
         fmt::format("the {}. obstacle's motion{}", i + 1, fastest_part(o, s.end_time)));
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
        fmt::format("correct it, or take velocity_scale = {:.4g}, the largest speed to expect",
                    speed));
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
  if (s.numerics.weight && by_resistance(plan.kernel.solid_term))
    plan.warnings.push_back(fmt::format("numerics.weight = \"{}\" has no effect: {} has no weight",
                                        name_of(*s.numerics.weight),
                                        name_of(plan.kernel.solid_term)));
}

/// Least width of an obstacle that the flow goes around [m]; nothing where it has none.
std::optional<double> width_of(const Scene& s, const ObstacleScene& o) {
  if (o.grain || o.hollow) return std::nullopt;
  if (o.round) return o.diameter;
  if (!o.mesh || o.mesh->hollow || o.mesh->thickness > 0.0) return std::nullopt;
  const auto [low, high] = bounds(*o.mesh->surface);
  double least = high[0] - low[0];
  for (int k = 1; k < s.box.dimension; ++k) least = std::min(least, high[k] - low[k]);
  return least;
}

/// Obstacles of a few cells.
void check_widths(const Scene& s, Plan& plan) {
  Few thin(plan, "obstacles whose flow is not resolved");
  for (std::size_t i = 0; i < s.obstacles.size(); ++i) {
    const ObstacleScene& o = s.obstacles[i];
    if (const double cells = o.mesh ? o.mesh->thickness / plan.units.dx : 0.0;
        cells > 0.0 && cells < kTightLayer)
      plan.warnings.push_back(fmt::format(
          "obstacle.thickness = {:.4g} m is {:.3g} cells: fluid seeps through a layer of "
          "less than {}, where no cell is covered whole",
          o.mesh->thickness, cells, kTightLayer));
    const auto width = width_of(s, o);
    if (!width || *width >= kThinObstacle * plan.units.dx * (1.0 - 1e-9)) continue;
    thin.add([&] {
      return fmt::format(
          "{} is {:.2g} cells wide: the flow past it is not resolved; take a finer cell{}",
          o.round ? "the obstacle at " + place_text(s, o.centre)
                  : fmt::format("the {}. obstacle", i + 1),
          *width / plan.units.dx, *width < plan.units.dx && o.mesh ? ", or look at its scale" : "");
    });
  }
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
  check_widths(s, plan);
}

/// Sensors that find nothing to measure.
void check_periodic_sensors(const Scene& s, Plan& plan) {
  for (const SensorScene& sensor : s.output.sensors)
    if (sensor.kind == SensorScene::Kind::Side &&
        s.box.sides[axis_of(sensor.side)] == SideKind::Periodic)
      plan.warnings.push_back(
          fmt::format("sensor \"{}\": its side is periodic, where no wall takes a force: its "
                      "force stays 0; a plane measures the flow",
                      sensor.name));
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
  check_driven(s, plan);
  check_sizes(s, plan);
  check_frequencies(s, plan);
  check_motions(s, plan);
  check_idle_keys(s, plan);
  check_shapes(s, plan);
  check_overlaps(s, plan);
  check_starts_in_shapes(s, plan);
  check_tables(s, plan);
  check_periodic_sensors(s, plan);
  if (s.coupling) check_coupled(s, plan);
  check_output(s, plan);
}

}  // namespace lbm
