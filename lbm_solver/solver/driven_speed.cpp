// SPDX-License-Identifier: GPL-2.0-or-later
#include "lbm_solver/solver/driven_speed.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "lbm_solver/solver/motion_check.h"
#include "lbm_solver/solver/place_check.h"

namespace lbm {
namespace {

/// Smallest distance between walls, or width of the box where there are none [m].
double width(const Scene& s) {
  double walls = 0.0, box = s.box.size[0];
  for (int k = 0; k < s.box.dimension; ++k) {
    box = std::min(box, s.box.size[k]);
    if (s.box.sides[k] == SideKind::Wall)
      walls = walls > 0.0 ? std::min(walls, s.box.size[k]) : s.box.size[k];
  }
  return walls > 0.0 ? walls : box;
}

/// A channel of half-width w/2 under an acceleration: a parabola, or a free fall through the width.
double channel_speed(const Scene& s, double acceleration) {
  const double w = width(s);
  return std::min(acceleration * w * w / (8.0 * s.fluid.viscosity),
                  std::sqrt(2.0 * acceleration * w));
}

/// A sphere that falls: Stokes, or a drag coefficient of 0.44.
double falling_speed(const Scene& s) {
  double excess = 0.0;
  for (const double rho : {s.particles->density.lo, s.particles->density.hi})
    excess = std::max(excess, std::abs(rho / s.fluid.density - 1.0) * s.fluid.gravity.norm());
  const double d = s.particles->diameter.hi;
  return std::min(excess * d * d / (18.0 * s.fluid.viscosity),
                  std::sqrt(4.0 / 3.0 * excess * d / 0.44));
}

}  // namespace

double largest_pressure(const Scene& s) {
  double lo = 0.0, hi = 0.0;
  for (const BoundaryScene& b : s.boundaries) {
    const double most = std::abs(b.pressure) * b.table.largest();  // an oscillation has both signs
    const bool both = b.frequency > 0.0 || !b.table.times.empty();
    lo = std::min(lo, both ? -most : b.pressure);
    hi = std::max(hi, both ? most : b.pressure);
  }
  return std::max(hi - lo, s.box.pressure_jump.cwiseAbs().maxCoeff());
}

double opening_speed(const Scene& s, const BoundaryScene& b) {
  double area = s.box.dimension == 2 ? s.box.depth : 1.0;
  for (int k = 0; k < s.box.dimension - 1; ++k) {
    const Range part = extent(s, b, k);
    area *= part.hi - part.lo;
  }
  return std::abs(b.flow_rate.value_or(0.0)) * b.table.largest() / area;
}

double mean_speed(const Scene& s) {
  if (!s.fluid.flow) return 0.0;
  double area = s.box.dimension == 2 ? s.box.depth : 1.0;
  for (int k = 0; k < s.box.dimension; ++k)
    if (k != s.fluid.flow->axis) area *= s.box.size[k];
  return std::abs(s.fluid.flow->rate) / area;
}

std::vector<Drive> drives(const Scene& s) {
  std::vector<Drive> list;
  const auto add = [&list](double speed, std::string what) {
    if (speed > 0.0) list.push_back({speed, std::move(what)});
  };
  add(s.initial.velocity.norm(),
      fmt::format("initial.velocity = {:.3g} m/s", s.initial.velocity.norm()));
  for (const BoundaryScene& b : s.boundaries)
    add(opening_speed(s, b),
        fmt::format("boundary.flow_rate = {:.3g} m³/s", b.flow_rate.value_or(0.0)));
  for (const BoundaryScene& b : s.boundaries)
    add(b.velocity.norm() * b.table.largest() * b.profile.largest(),
        fmt::format("boundary.velocity = {:.3g} m/s", b.velocity.norm()));
  for (const ObstacleScene& o : s.obstacles)
    add(0.5 * o.diameter * o.spin.norm(),
        fmt::format("an obstacle's spin = {:.3g} rad/s", o.spin.norm()));
  for (const ObstacleScene& o : s.obstacles)
    if (o.motion)
      if (const double speed = largest_speed(*o.motion, reach_of(o), s.end_time); speed > 0.0)
        add(speed, fmt::format("an obstacle's motion at {:.3g} m/s", speed));
  const double force = s.fluid.body_force.norm() * s.fluid.body_force_table.largest(),
               pressure = largest_pressure(s);
  add(channel_speed(s, force), fmt::format("fluid.body_force = {:.3g} m/s²", force));
  if (s.fluid.flow)
    add(mean_speed(s), fmt::format("fluid.flow_rate = {:.3g} m³/s", s.fluid.flow->rate));
  add(std::sqrt(2.0 * pressure / s.fluid.density),
      fmt::format("a pressure difference of {:.3g} Pa", pressure));
  if (s.particles && s.coupling)
    add(falling_speed(s),
        fmt::format("fluid.gravity = {:.3g} m/s² on the particles", s.fluid.gravity.norm()));
  std::ranges::stable_sort(list, std::greater(), &Drive::speed);
  return list;
}

}  // namespace lbm
