// SPDX-License-Identifier: GPL-2.0-or-later
/// From a scene and its plan to a fluid: boundaries, obstacles, initial state.
#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include "lbm_solver/base/errors.h"
#include "lbm_solver/solver/plan.h"

namespace lbm {
namespace {

/// Nearest cell border of a length along an axis; complains where it lies off by more than a tenth.
int border(const Scene& s, const Plan& p, double at, int axis, const std::string& what) {
  const double cells = (at - s.box.origin[axis]) / p.units.dx, whole = std::round(cells);
  if (std::abs(cells - whole) > 0.1)
    throw InputError(
        s.file + ": " + what,
        fmt::format("{:.6g} m lies {:.2f} cells off a cell border", at, std::abs(cells - whole)),
        fmt::format("take {:.6g} m, or another cell", s.box.origin[axis] + whole * p.units.dx));
  return static_cast<int>(whole);
}

void add_boundary(const Scene& s, const Plan& p, const BoundaryScene& b, Fluid& fluid) {
  const bool vertical = b.side == SideName::Left || b.side == SideName::Right;
  const int axis = vertical ? 1 : 0, n = vertical ? p.domain.ny : p.domain.nx;
  const int begin = b.from ? border(s, p, *b.from, axis, "boundary.from") : 0;
  const int end = b.to ? border(s, p, *b.to, axis, "boundary.to") : n;
  if (begin >= end)
    throw InputError(s.file + ": boundary", "has from at or beyond to", "give from < to");
  const bool closed =
      begin == 0 && end == n && (vertical ? p.domain.y : p.domain.x) == Side::Periodic;
  auto links = side_links(p.domain.nx, p.domain.ny, b.side, begin, end, closed);
  const InTime in_time{b.ramp / p.units.dt,
                       b.frequency > 0.0 ? 1.0 / (b.frequency * p.units.dt) : 0.0};
  if (b.kind == BoundaryScene::Kind::Velocity) {
    fluid.add(std::make_unique<VelocityPatch>(std::move(links),
                                              p.units.to_lattice_velocity(b.velocity), b.parabolic,
                                              begin, end, in_time));
    return;
  }
  const double drho = b.pressure / p.units.pressure();
  if (b.kind == BoundaryScene::Kind::Pressure) {
    fluid.add(std::make_unique<PressurePatch>(std::move(links), b.side, drho, in_time));
    return;
  }
  const double length = std::max(p.domain.nx, p.domain.ny);
  fluid.add(std::make_unique<OutflowPatch>(std::move(links), b.side, drho,
                                           1.0 / (std::numbers::sqrt3 * length)));
}

void add_pressure_jump(const Plan& p, int axis, double jump, Fluid& fluid) {
  const SideName sides[] = {axis == 0 ? SideName::Left : SideName::Bottom,
                            axis == 0 ? SideName::Right : SideName::Top};
  const int n = axis == 0 ? p.domain.ny : p.domain.nx;
  const bool closed = (axis == 0 ? p.domain.y : p.domain.x) == Side::Periodic;
  double sign = 1.0;
  for (const SideName side : sides) {
    fluid.add(std::make_unique<PressureJumpPatch>(
        side_links(p.domain.nx, p.domain.ny, side, 0, n, closed), side,
        sign * jump / p.units.pressure(), InTime{}));
    sign = -1.0;
  }
}

void add_block(const Scene& s, const Plan& p, const ObstacleScene& o, Fluid& fluid) {
  int corner[4];
  for (int axis = 0; axis < 2; ++axis) {
    corner[axis] = border(s, p, o.from[axis], axis, "obstacle.from");
    corner[2 + axis] = border(s, p, o.to[axis], axis, "obstacle.to");
  }
  if (corner[0] < 0 || corner[1] < 0 || corner[2] > p.domain.nx || corner[3] > p.domain.ny ||
      corner[0] >= corner[2] || corner[1] >= corner[3])
    throw InputError(
        s.file + ": obstacle",
        fmt::format("[{:.6g}, {:.6g}] … [{:.6g}, {:.6g}] m is empty or outside the box", o.from.x(),
                    o.from.y(), o.to.x(), o.to.y()),
        "give its lower left and upper right corner");
  fluid.add_wall(corner[0], corner[1], corner[2], corner[3]);
}

/// Velocity and pressure deviation of the initial state, lattice units, at a place in units of the
/// box.
struct Start {
  double drho;
  Vec2 u;
};
Start start(const InitialScene& i, const Units& units, double x, double y) {
  const Vec2 u = units.to_lattice_velocity(i.velocity);
  const double k = 2.0 * std::numbers::pi, u0 = u.x();
  switch (i.kind) {
    case InitialScene::Kind::Rest:
      return {0.0, {0.0, 0.0}};
    case InitialScene::Kind::Uniform:
      return {0.0, u};
    case InitialScene::Kind::Channel:
      return {0.0, 4.0 * y * (1.0 - y) * u};
    case InitialScene::Kind::TaylorGreen:
      return {-0.75 * u0 * u0 * (std::cos(2.0 * k * x) + std::cos(2.0 * k * y)),
              {u0 * std::cos(k * x) * std::sin(k * y), -u0 * std::sin(k * x) * std::cos(k * y)}};
    case InitialScene::Kind::ShearLayer:  // Minion and Brown 1997
      return {0.0,
              {u0 * (y <= 0.5 ? std::tanh(i.sharpness * (y - 0.25))
                              : std::tanh(i.sharpness * (0.75 - y))),
               u0 * i.perturbation * std::sin(k * (x + 0.25))}};
  }
  return {0.0, {0.0, 0.0}};
}

}  // namespace

std::vector<Disc> obstacle_discs(const Scene& s, const Plan& p) {
  std::vector<Disc> discs;
  for (const ObstacleScene& o : s.obstacles)
    if (o.disc)
      discs.push_back({-static_cast<std::int64_t>(discs.size() + 1),
                       p.units.to_lattice_position(o.centre),
                       0.5 * o.diameter / p.units.dx,
                       {0.0, 0.0},
                       p.units.to_lattice_spin(o.spin),
                       o.hollow});
  return discs;
}

Fluid make_fluid(const Scene& s, const Plan& p) {
  Fluid fluid(p.domain, p.kernel);
  for (const BoundaryScene& b : s.boundaries) add_boundary(s, p, b, fluid);
  for (int axis = 0; axis < 2; ++axis)
    if (s.box.pressure_jump[axis] != 0.0)
      add_pressure_jump(p, axis, s.box.pressure_jump[axis], fluid);
  for (const ObstacleScene& o : s.obstacles)
    if (!o.disc) add_block(s, p, o, fluid);
  if (p.scheme != known_schemes().front())
    fluid.use(make_scheme(
        p.scheme, p.domain,
        {p.kernel.force ? 0.5 * Vec2(p.kernel.parameters.force_x, p.kernel.parameters.force_y)
                        : Vec2(0.0, 0.0),
         s.numerics.spring_stiffness}));
  fluid.prepare_walls();
  if (fluid.has_solids()) fluid.place(obstacle_discs(s, p));
  if (s.initial.kind != InitialScene::Kind::Rest || p.kernel.force)
    for (int y = 0; y < p.domain.ny; ++y)
      for (int x = 0; x < p.domain.nx; ++x) {
        const Start at =
            start(s.initial, p.units, (x + 0.5) / p.domain.nx, (y + 0.5) / p.domain.ny);
        fluid.set_equilibrium(x, y, 1.0 + at.drho, at.u);
      }
  return fluid;
}

}  // namespace lbm
