// SPDX-License-Identifier: GPL-2.0-or-later
#include "lbm_solver/solver/drive_check.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>
#include <numbers>

#include "lbm_solver/solver/driven_speed.h"
#include "lbm_solver/solver/flow_control.h"
#include "lbm_solver/solver/held_lag.h"
#include "lbm_solver/solver/pressure_control.h"

namespace lbm {
namespace {

constexpr double kShareOfGrain = 0.1;  // seen: 0.84 of the force where a whole grain would make 8
constexpr double kMuchRoundOff = 0.01;
constexpr double kMargin = 1.5;       // of an advice against it, which is rounded
constexpr double kRoom = 2.0;         // of a velocity scale over the mean speed
constexpr double kThinChannel = 8.0;  // cells
constexpr int kTurns = 2;             // of a table that goes up and down
constexpr int kHarmonics = 64;        // of a table, that are looked at
constexpr int kSamples = 4 * kHarmonics;
constexpr double kFollows = 0.05;  // of an amplitude, or of a period, which a flow may lack
constexpr double kUnknown = std::numeric_limits<double>::infinity();  // a stress that may be any

/// Smallest distance between walls that lie along an axis [m]; 0: there are none.
double gap_along(const Scene& s, int axis) {
  double gap = 0.0;
  for (int k = 0; k < s.box.dimension; ++k)
    if (k != axis && s.box.sides[k] == SideKind::Wall)
      gap = gap > 0.0 ? std::min(gap, s.box.size[k]) : s.box.size[k];
  return gap;
}

/// Load on an isolated disc or sphere over σ_y D (a layer or the square), beyond which a yield
/// stress σ_y does not hold it: 4√2 + 2π [RandolphHoulsby1984], π/(6·0.0477) [Beris1985].
double capacity(int dimension) {
  return dimension == 2 ? 4.0 * std::numbers::sqrt2 + 2.0 * std::numbers::pi
                        : std::numbers::pi / (6.0 * 0.0477);
}

/// Largest yield stress that a force on each volume of fluid along an axis overcomes [Pa]. Between
/// walls G H/2, whatever lies in the channel besides: a stress that grows so towards the walls
/// bears the force. Around discs or spheres their capacity, and the shear between two rows of them;
/// else at most G times the box.
double stress_of(const Scene& s, double force, int axis) {
  if (force == 0.0) return 0.0;
  if (const double gap = gap_along(s, axis); gap > 0.0) return 0.5 * force * gap;
  if (s.obstacles.empty()) return kUnknown;  // nothing resists
  const int d = s.box.dimension;
  double borne = 0.0, volume = 1.0, across = kUnknown;
  bool round = true;
  for (const ObstacleScene& o : s.obstacles) {
    round = round && o.round && !o.hollow;
    borne += capacity(d) * std::pow(o.diameter, d - 1);
  }
  for (int k = 0; k < d; ++k) {
    volume *= s.box.size[k];
    if (k != axis) across = std::min(across, s.box.size[k]);
  }
  return round ? force * volume / borne + 0.5 * force * across : force * across;
}

/// Whether something moves at a velocity of its own, which no yield stress stops.
bool has_given_motion(const Scene& s) {
  const auto moves = [](const BoundaryScene& b) {
    return b.velocity.norm() * b.table.largest() > 0.0 || b.flow_rate.value_or(0.0) != 0.0;
  };
  const auto turns = [](const ObstacleScene& o) { return o.motion || !o.spin.isZero(0.0); };
  return std::ranges::any_of(s.boundaries, moves) || std::ranges::any_of(s.obstacles, turns) ||
         (s.fluid.flow && s.fluid.flow->rate != 0.0) || s.initial.velocity.norm() > 0.0;
}

/// Of pressures on openings, or across periodic sides. @param axis  along which they drive; left
/// where there are none
double stress_of_pressure(const Scene& s, int& axis) {
  const double pressure = largest_pressure(s);
  if (pressure == 0.0) return 0.0;
  axis = -1;
  for (const BoundaryScene& b : s.boundaries) {
    if (axis >= 0 && axis_of(b.side) != axis) return kUnknown;  // around a corner
    axis = axis_of(b.side);
    if (std::ranges::count(s.boundaries, b.side, &BoundaryScene::side) > 1) return kUnknown;
  }
  if (axis < 0) s.box.pressure_jump.cwiseAbs().maxCoeff(&axis);
  return stress_of(s, pressure / s.box.size[axis], axis);
}

/// Of a particle's weight in the fluid.
double stress_of_weight(const Scene& s) {
  double excess = 0.0;
  for (const double density : {s.particles->density.lo, s.particles->density.hi})
    excess = std::max(excess, std::abs(density - s.fluid.density));
  const double volume = s.box.dimension == 2 ? std::numbers::pi / 4.0 : std::numbers::pi / 6.0;
  return excess * s.fluid.gravity.norm() * s.particles->diameter.hi * volume /
         capacity(s.box.dimension);
}

/// Of the body force on a volume of fluid, at its largest [N/m³]. @param axis  its own
double largest_force(const Scene& s, int& axis) {
  return s.fluid.body_force.cwiseAbs().maxCoeff(&axis) > 0.0
             ? s.fluid.density * s.fluid.body_force.norm() * s.fluid.body_force_table.largest()
             : 0.0;
}

/// A yield stress that nothing overcomes.
void check_held(const Scene& s, Plan& plan) {
  const double yield = s.fluid.law.yield_stress;
  if (yield == 0.0 || has_given_motion(s)) return;
  int axis = 0;
  const double force = largest_force(s, axis);
  double stress = stress_of(s, force, axis);
  stress += stress_of_pressure(s, axis);
  const bool grains = s.particles && s.coupling;
  if (grains) stress += stress_of_weight(s);
  if (stress == 0.0 || stress >= yield) return;
  plan.warnings.push_back(fmt::format(
      "fluid.viscosity.yield_stress = {:.3g} Pa holds everything: what drives here overcomes "
      "{:.2g} Pa at most{}, so that nothing moves but by the creep of nu_max; take a lower yield "
      "stress or a stronger drive, if that is not meant",
      yield, stress, grains ? ", single particles by their weight included" : ""));
}

/// Period of what swings most in a table, by the largest harmonic of its span [s]; 0 where a table
/// that does not repeat goes up and down less than once.
double period_of(const TimeTableScene& table) {
  const std::vector<double>&times = table.times, &factors = table.factors;
  const double span = times.empty() ? 0.0 : times.back() - times.front();
  int turns = 0;
  for (std::size_t i = 1; i + 1 < times.size(); ++i)
    turns += (factors[i] - factors[i - 1]) * (factors[i + 1] - factors[i]) < 0.0;
  if (span == 0.0 || (!table.repeats && turns < kTurns)) return 0.0;
  std::vector<std::complex<double>> harmonics(kHarmonics);
  std::size_t line = 0;
  for (int i = 0; i < kSamples; ++i) {
    const double part = (i + 0.5) / kSamples, time = times.front() + part * span;
    while (times[line + 1] < time) ++line;
    const double value = std::lerp(factors[line], factors[line + 1],
                                   (time - times[line]) / (times[line + 1] - times[line]));
    for (int k = 0; k < kHarmonics; ++k)
      harmonics[k] += std::polar(value, -2.0 * std::numbers::pi * (k + 1) * part);
  }
  const auto largest = std::ranges::max_element(
      harmonics, {}, [](const std::complex<double>& h) { return std::norm(h); });
  return span / static_cast<double>(largest - harmonics.begin() + 1);
}

void check_lag(const Scene& s, const BoundaryScene& b, Plan& plan) {
  const double period = b.frequency > 0.0 ? 1.0 / b.frequency : period_of(b.table);
  if (period == 0.0) return;
  const int axis = axis_of(b.side), cells = plan.domain.cells()[axis];
  const bool outflow =
      std::ranges::count(s.boundaries, BoundaryScene::Kind::Outflow, &BoundaryScene::kind) > 0;
  const std::complex<double> part = held_part({cells, gap_along(s, axis) / plan.units.dx,
                                               (plan.kernel.parameters.tau - 0.5) / 3.0, outflow},
                                              period / plan.units.dt);
  const double amplitude = std::abs(part), late = -std::arg(part) / (2.0 * std::numbers::pi);
  if (std::abs(amplitude - 1.0) < kFollows && std::abs(late) < kFollows) return;
  const bool solids = !s.obstacles.empty() || s.coupling;
  plan.warnings.push_back(fmt::format(
      "boundary.flow_rate follows what is slow beside {:.3g} s, eight crossings of the box by "
      "sound: of a flow with a period of {:.3g} s some {:.0f} % comes, {:.2g} of a period {}{}; "
      "take a longer period, or a boundary of kind \"velocity\", whose flow follows at once",
      PressureControl::time(cells) * plan.units.dt, period, 100.0 * amplitude, std::abs(late),
      late < 0.0 ? "early" : "late",
      solids    ? " in an empty box, and much less through solids"
      : outflow ? " (before an outflow up to a tenth of the flow less)"
                : ""));
}

/// What can be done against round-off. Its part falls with the square of a longer step; with the
/// cell to the power of d where the step grows with the cell, of d + 2 where τ binds it and it
/// grows with the cell's area.
std::string way_out_of_round_off(const Scene& s, const Plan& plan, double width, double part) {
  const double longer = plan.units.dt * std::sqrt(kMargin * part / kMuchRoundOff);
  const double by_tau = plan.units.dx * plan.units.dx / (3.0 * s.fluid.viscosity);  // τ = 1.5
  if (longer <= by_tau && longer <= kWarnSpeed * plan.units.dx / s.fluid.velocity_scale)
    return fmt::format("take numerics.time_step = {:.2g} s", longer);
  const double scale = kWarnSpeed * plan.units.dx / longer;
  if (longer <= by_tau && plan.step_bound == StepBound::Speed && scale > kRoom * mean_speed(s))
    return fmt::format("take fluid.velocity_scale = {:.2g} m/s", scale);
  const int power = s.box.dimension + (plan.step_bound == StepBound::Relaxation ? 2 : 0);
  const double cell = plan.units.dx * std::pow(kMargin * part / kMuchRoundOff, 1.0 / power);
  if (width > kThinChannel * cell)
    return fmt::format("take cells of {:.2g} m or more{}", cell,
                       plan.step_bound == StepBound::Given
                           ? " and a numerics.time_step that is as much longer"
                           : "");
  return fmt::format("give fluid.body_force in its place, {:.3g} m/s² in a channel without solids",
                     12.0 * s.fluid.viscosity * mean_speed(s) / (width * width));
}

/// A held flow so slow that the rounding of momenta shows in the force that is found. It is a part
/// of a grain, shared by the cells' many values, over Δ; the force of a channel is 12 ν U/H².
void check_round_off(const Scene& s, Plan& plan) {
  const double speed = mean_speed(s) / plan.units.velocity();
  if (speed == 0.0) return;
  const int axis = s.fluid.flow->axis;
  const Cell3 cells = plan.domain.cells();
  double width = gap_along(s, axis);
  for (int k = 0; k < s.box.dimension && gap_along(s, axis) == 0.0; ++k)
    if (k != axis) width = std::max(width, s.box.size[k]);
  const double nu = (plan.kernel.parameters.tau - 0.5) / 3.0;
  const double force = 12.0 * nu * speed / std::pow(width / plan.units.dx, 2);
  const double grain = kShareOfGrain * momentum_grain(cells);
  const double part = grain / static_cast<double>(FlowControl::look_every(cells[axis])) / force;
  if (part > kMuchRoundOff)
    plan.warnings.push_back(
        fmt::format("fluid.flow_rate is a mean of {:.2g} Δx/Δt: round-off makes some {:.2g} % of "
                    "the force that is found for it; {}",
                    speed, 100.0 * part, way_out_of_round_off(s, plan, width, part)));
}

}  // namespace

void check_driven(const Scene& s, Plan& plan) {
  check_held(s, plan);
  check_round_off(s, plan);
  for (const BoundaryScene& b : s.boundaries)
    if (b.flow_rate) check_lag(s, b, plan);
}

double channel_wall_stress(const Scene& s) {
  const bool solids = !s.obstacles.empty() || (s.particles && s.coupling);
  int axis = 0;
  const double force = largest_force(s, axis);
  double stress = stress_of(s, force, axis);
  stress += stress_of_pressure(s, axis);
  if (solids || has_given_motion(s) || stress >= kUnknown) return 0.0;
  int walls = 0;
  for (int k = 0; k < s.box.dimension; ++k) walls += s.box.sides[k] == SideKind::Wall && k != axis;
  return walls == 1 ? stress : 0.0;
}

}  // namespace lbm
