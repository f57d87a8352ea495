// SPDX-License-Identifier: GPL-2.0-or-later
#include "lbm_solver/solver/place_check.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "lbm_solver/base/errors.h"

namespace lbm {
namespace {

constexpr double kLightest = 0.1;  // density of a particle over the fluid's

void check_particles(const Scene& s) {
  const ParticleScene& p = *s.particles;
  if (s.coupling && p.density.lo < kLightest * s.fluid.density)
    throw InputError(fmt::format("{}: particles.density = {:.6g} kg/m³ is below {} of the fluid's: "
                                 "the coupling is not proven stable there",
                                 s.file, p.density.lo, kLightest),
                     fmt::format("take at least {:.6g} kg/m³", kLightest * s.fluid.density));
  const double width = s.box.size.head(s.box.dimension).minCoeff();
  if (p.diameter.hi > width)
    throw InputError(
        fmt::format("{}: particles.diameter = {:.6g} m is wider than the box ({:.6g} m)", s.file,
                    p.diameter.hi, width),
        "take a smaller particle or a larger box");
  const auto half_periodic = [&](SideKind side, double length) {
    return side == SideKind::Periodic && p.diameter.hi > 0.5 * length;
  };
  for (int k = 0; k < s.box.dimension; ++k)
    if (half_periodic(s.box.sides[k], s.box.size[k]))
      throw InputError(
          fmt::format("{}: particles.diameter = {:.6g} m exceeds half of a periodic length", s.file,
                      p.diameter.hi),
          "take a longer box");
}

/// Discs that the scene places: inside the box, none in another.
void check_starts(const Scene& s) {
  const ParticleScene& p = *s.particles;
  const double r = 0.5 * p.diameter.lo;
  const int d = s.box.dimension;
  for (std::size_t i = 0; i < p.start.size(); ++i) {
    const Vec3& x = p.start[i];
    for (int k = 0; k < d; ++k) {
      const double margin = s.box.sides[k] == SideKind::Wall ? r : 0.0;
      const double lo = s.box.origin[k] + margin, hi = s.box.origin[k] + s.box.size[k] - margin;
      if (x[k] < lo - 1e-12 || x[k] > hi + 1e-12)
        throw InputError(
            s.file + ": particles.start",
            fmt::format("{} with radius {:.6g} m lies outside the box", place_text(s, x), r),
            fmt::format("keep its centre within {:.6g} … {:.6g} m in {}", lo, hi, "xyz"[k]));
    }
    for (std::size_t j = 0; j < i; ++j) {
      Vec3 apart = x - p.start[j];
      for (int k = 0; k < d; ++k)
        if (s.box.sides[k] == SideKind::Periodic)
          apart[k] = std::remainder(apart[k], s.box.size[k]);
      if (const double distance = apart.norm(); distance < 2.0 * r * (1.0 - 1e-6))
        throw InputError(s.file + ": particles.start",
                         fmt::format("{} and {} overlap by {:.4g} m", place_text(s, p.start[j]),
                                     place_text(s, x), 2.0 * r - distance),
                         fmt::format("keep centres a diameter apart, {:.6g} m", 2.0 * r));
    }
  }
}

/// Shortest vector between two places of the box.
Vec3 apart(const Scene& s, const Vec3& a, const Vec3& b) {
  Vec3 way = b - a;
  for (int k = 0; k < s.box.dimension; ++k)
    if (s.box.sides[k] == SideKind::Periodic) way[k] = std::remainder(way[k], s.box.size[k]);
  return way;
}

/// Particles that the scene starts in an obstacle.
void check_starts_in_obstacles(const Scene& s) {
  const double r = 0.5 * s.particles->diameter.lo;
  for (const Vec3& x : s.particles->start)
    for (const ObstacleScene& o : s.obstacles)
      if (depth_in(s, o, x, r) > kTouch)
        throw InputError(
            s.file + ": particles.start",
            fmt::format("{} with radius {:.6g} m lies in the obstacle at {}", place_text(s, x), r,
                        place_text(s, o.round ? o.centre : o.from)),
            "move the particle or the obstacle");
}

void check_inside(const Scene& s, const Vec3& x, const std::string& what) {
  for (int k = 0; k < s.box.dimension; ++k) {
    const double lo = s.box.origin[k], hi = lo + s.box.size[k];
    if (x[k] < lo || x[k] > hi)
      throw InputError(s.file + ": " + what, place_text(s, x) + " lies outside the box",
                       fmt::format("the box is {:.6g} … {:.6g} m in {}", lo, hi, "xyz"[k]));
  }
}

void check_points(const Scene& s) {
  for (const Vec3& x : s.output.points) check_inside(s, x, "output.points");
}

void check_sensors(const Scene& s) {
  std::set<std::string> names;
  for (const SensorScene& sensor : s.output.sensors) {
    const std::string what = fmt::format("sensor \"{}\"", sensor.name);
    if (!names.insert(sensor.name).second)
      throw InputError(s.file + ": " + what, "is the name of two sensors",
                       "each has a table of its own: choose another name");
    check_inside(s, sensor.from, what);
    check_inside(s, sensor.to, what);
    if (sensor.kind == SensorScene::Kind::Line && sensor.from == sensor.to)
      throw InputError(s.file + ": " + what,
                       "is a line of no length: from and to are " + place_text(s, sensor.from),
                       "give its two ends, or output.points for a place");
    for (int k = 0; k < s.box.dimension; ++k)
      if (sensor.kind == SensorScene::Kind::Plane && k != sensor.axis &&
          !(sensor.from[k] < sensor.to[k]))
        throw InputError(s.file + ": " + what,
                         fmt::format("is empty: from {:.6g} to {:.6g} m in {}", sensor.from[k],
                                     sensor.to[k], "xyz"[k]),
                         "give the lower corner as from, the upper as to");
  }
  const auto& average = s.output.average;
  if (average && average->from >= s.end_time)
    throw InputError(fmt::format("{}: average.from = {:.6g} s is not before the end at {:.6g} s",
                                 s.file, average->from, s.end_time),
                     "average from an earlier time on");
}

void check_obstacle(const Scene& s, const ObstacleScene& o) {
  if (!o.round) return;  // blocks and images are checked with their cells, meshes when read
  for (int k = 0; k < s.box.dimension; ++k) {
    const double lo = s.box.origin[k], hi = lo + s.box.size[k], r = 0.5 * o.diameter;
    if (o.centre[k] + r <= lo || o.centre[k] - r >= hi)
      throw InputError(key_of(s, o),
                       fmt::format("{} with diameter {:.6g} m lies outside the box",
                                   place_text(s, o.centre), o.diameter),
                       fmt::format("the box is {:.6g} … {:.6g} m in {}", lo, hi, "xyz"[k]));
  }
}

void check_boundaries(const Scene& s) {
  for (std::size_t i = 0; i < s.boundaries.size(); ++i)
    for (std::size_t j = 0; j < i; ++j) {
      const BoundaryScene &a = s.boundaries[j], &b = s.boundaries[i];
      bool shared = a.side == b.side;
      for (int k = 0; k < s.box.dimension - 1; ++k) {
        const Range first = extent(s, a, k), second = extent(s, b, k);
        shared = shared && std::min(first.hi, second.hi) > std::max(first.lo, second.lo);
      }
      if (shared)
        throw InputError(s.file,
                         fmt::format("boundaries {} and {} overlap on side \"{}\"", j + 1, i + 1,
                                     name_of(a.side)),
                         "part them with from and to, or leave one out");
    }
}

/// One pressure can be found at a time, and a flow that it drives must get out elsewhere.
void check_held_openings(const Scene& s) {
  const auto holds = [](const BoundaryScene& b) { return b.flow_rate.has_value(); };
  if (std::ranges::none_of(s.boundaries, holds)) return;
  const std::string key = s.file + ": boundary.flow_rate";
  if (std::ranges::count_if(s.boundaries, holds) > 1)
    throw InputError(key, "stands at more than one boundary, and one pressure is found at a time",
                     "give the others a pressure, or a velocity whose flow is known");
  if (s.fluid.flow) throw InputError(key, "stands beside fluid.flow_rate", "leave one of them out");
  if (std::ranges::none_of(s.boundaries, [](const BoundaryScene& b) {
        return b.kind != BoundaryScene::Kind::Velocity && !b.flow_rate;
      }))
    throw InputError(key, "has no other opening with a pressure, through which the flow gets out",
                     "add a boundary of kind \"pressure\" or \"outflow\"");
}

/// The body force is free to give a flow where nothing else drives it, or holds it.
void check_flow(const Scene& s) {
  if (!s.fluid.flow) return;
  const int axis = s.fluid.flow->axis;
  const std::string key = s.file + ": fluid.flow_rate";
  if (s.box.sides[axis] != SideKind::Periodic)
    throw InputError(
        key,
        fmt::format("goes along {0}, and sides_{0} are walls: nothing can flow there", "xyz"[axis]),
        fmt::format("make box.sides_{} \"periodic\", give another fluid.flow_axis, or a "
                    "[[boundary]] velocity whose flow is known",
                    "xyz"[axis]));
  if (s.box.pressure_jump[axis] != 0.0 || s.fluid.body_force[axis] != 0.0)
    throw InputError(
        key,
        fmt::format("stands beside {} along {}, and finds the force itself",
                    s.fluid.body_force[axis] != 0.0 ? "fluid.body_force" : "box.pressure_jump",
                    "xyz"[axis]),
        "leave one of them out");
}

/// A force can carry the weight only where nothing else does.
void check_carried_weight(const Scene& s) {
  if (!s.coupling || !s.coupling->carry_weight) return;
  for (int k = 0; k < s.box.dimension; ++k)
    if (s.fluid.gravity[k] != 0.0 && s.box.sides[k] != SideKind::Periodic)
      throw InputError(
          s.file + ": coupling.carry_weight",
          fmt::format("stands beside walls across {}, along which gravity acts: the "
                      "walls carry the weight",
                      "xyz"[k]),
          fmt::format("make box.sides_{} \"periodic\", or leave the key out", "xyz"[k]));
  if (s.fluid.body_force_ramp > 0.0)
    throw InputError(s.file + ": coupling.carry_weight",
                     "stands beside fluid.body_force_ramp, which would delay it too",
                     "leave one of them out");
}

}  // namespace

std::string place_text(const Scene& s, const Vec3& x) {
  return s.box.dimension == 2 ? fmt::format("[{:.6g}, {:.6g}]", x.x(), x.y())
                              : fmt::format("[{:.6g}, {:.6g}, {:.6g}]", x.x(), x.y(), x.z());
}

std::string key_of(const Scene& s, const ObstacleScene& o, const std::string& key) {
  return fmt::format("{}: obstacle{}{}", o.where.empty() ? s.file : o.where, key.empty() ? "" : ".",
                     key);
}

double depth_in(const Scene& s, const ObstacleScene& o, const Vec3& x, double r) {
  if (o.round && o.hollow) return (apart(s, o.centre, x).norm() + r - 0.5 * o.diameter) / (2.0 * r);
  if (o.round) return (0.5 * o.diameter + r - apart(s, o.centre, x).norm()) / (2.0 * r);
  if (!o.block()) return 0.0;  // of a mesh or an image the cells know
  Vec3 outside = Vec3::Zero();
  for (int k = 0; k < s.box.dimension; ++k)
    outside[k] = std::max({o.from[k] - x[k], x[k] - o.to[k], 0.0});
  return (r - outside.norm()) / (2.0 * r);
}

Range extent(const Scene& s, const BoundaryScene& b, int k) {
  const int axis = axis_along(b.side, k);
  const double lo = s.box.origin[axis];
  return {b.from[k].value_or(lo), b.to[k].value_or(lo + s.box.size[axis])};
}

void check_places(const Scene& s) {
  check_carried_weight(s);
  check_flow(s);
  check_held_openings(s);
  if (s.particles) {
    check_particles(s);
    check_starts(s);
    check_starts_in_obstacles(s);
  }
  for (const ObstacleScene& o : s.obstacles) check_obstacle(s, o);
  check_points(s);
  check_sensors(s);
  check_boundaries(s);
}

}  // namespace lbm
