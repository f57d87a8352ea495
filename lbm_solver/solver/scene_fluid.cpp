// SPDX-License-Identifier: GPL-2.0-or-later
/// From a scene and its plan to a fluid: boundaries, obstacles, initial state.
#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "lbm_solver/base/errors.h"
#include "lbm_solver/immersed/geometry.h"
#include "lbm_solver/immersed/solid_term.h"
#include "lbm_solver/solver/driven_speed.h"
#include "lbm_solver/solver/place_check.h"
#include "lbm_solver/solver/plan.h"

namespace lbm {
namespace {

/// Nearest cell border of a length along an axis; complains where it lies off by more than a tenth.
/// @param key  with its file, as a message begins
int border(const Scene& s, const Plan& p, double at, int axis, const std::string& key) {
  const double cells = (at - s.box.origin[axis]) / p.units.dx, whole = std::round(cells);
  if (std::abs(cells - whole) > 0.1)
    throw InputError(
        key,
        fmt::format("{:.6g} m lies {:.2f} cells off a cell border", at, std::abs(cells - whole)),
        fmt::format("take {:.6g} m, or another cell", s.box.origin[axis] + whole * p.units.dx));
  return static_cast<int>(whole);
}

/// The cells of a side that a boundary takes.
Opening opening(const Scene& s, const Plan& p, const BoundaryScene& b) {
  Opening o = Opening::whole(p.domain, b.side);
  const int axis = axis_of(b.side);
  const int along[] = {axis == 0 ? 1 : 0, axis == 2 ? 1 : 2};
  for (int k = 0; k < s.box.dimension - 1; ++k) {
    if (b.from[k]) o.begin[k] = border(s, p, *b.from[k], along[k], s.file + ": boundary.from");
    if (b.to[k]) o.end[k] = border(s, p, *b.to[k], along[k], s.file + ": boundary.to");
    if (o.begin[k] >= o.end[k])
      throw InputError(s.file + ": boundary", "has from at or beyond to", "give from < to");
    o.closed[k] = o.closed[k] && o.begin[k] == 0 && o.end[k] == p.domain.cells()[along[k]];
  }
  return o;
}

/// A value's way in time, in steps.
InTime in_time(const Plan& p, double ramp, double frequency, const TimeTableScene& table) {
  InTime t{ramp / p.units.dt, frequency > 0.0 ? 1.0 / (frequency * p.units.dt) : 0.0};
  if (table.times.empty()) return t;
  TimeTable steps{table.times, table.factors, table.repeats};
  for (double& time : steps.steps) time /= p.units.dt;
  t.table = std::make_shared<TimeTable>(std::move(steps));
  return t;
}

SideProfile profile(const Scene& s, const Plan& p, const BoundaryScene& b) {
  SideProfile cells{b.profile.places, b.profile.factors};
  for (int k = 0; k < 2; ++k)
    for (double& place : cells.places[k])
      place = (place - s.box.origin[axis_along(b.side, k)]) / p.units.dx;
  return cells;
}

void add_boundary(const Scene& s, const Plan& p, const BoundaryScene& b, Fluid& fluid) {
  const Opening o = opening(s, p, b);
  const InTime value = in_time(p, b.ramp, b.frequency, b.table);
  if (!b.profile.factors.empty()) {
    fluid.add(std::make_unique<VelocityPatch>(fluid.lattice(), fluid.links(o),
                                              p.units.to_lattice_velocity(b.velocity),
                                              profile(s, p, b), value));
    return;
  }
  if (b.kind == BoundaryScene::Kind::Velocity) {
    fluid.add(std::make_unique<VelocityPatch>(fluid.lattice(), fluid.links(o),
                                              p.units.to_lattice_velocity(b.velocity), b.parabolic,
                                              o, value));
    return;
  }
  const double drho = b.pressure / p.units.pressure();
  if (b.kind == BoundaryScene::Kind::Pressure) {
    const InTime held = b.flow_rate ? InTime{} : value;  // in time the flow changes
    fluid.add(std::make_unique<PressurePatch>(fluid.links(o), b.side, drho, held));
    return;
  }
  const double length = std::max({p.domain.nx, p.domain.ny, p.domain.nz});
  fluid.add(std::make_unique<OutflowPatch>(fluid.links(o), b.side, drho,
                                           1.0 / (std::numbers::sqrt3 * length)));
}

void add_pressure_jump(const Plan& p, int axis, double jump, Fluid& fluid) {
  double sign = 1.0;
  for (int high = 0; high < 2; ++high) {
    const auto side = static_cast<SideName>(2 * axis + high);
    fluid.add(std::make_unique<PressureJumpPatch>(fluid.links(Opening::whole(p.domain, side)), side,
                                                  sign * jump / p.units.pressure(), InTime{}));
    sign = -1.0;
  }
}

FlowControl flow_control(const Scene& s, const Plan& p) {
  const FlowScene& flow = *s.fluid.flow;
  const double speed = std::copysign(mean_speed(s), flow.rate) / p.units.velocity();
  return {flow.axis, speed, {.ramp_steps = flow.ramp / p.units.dt}, p.domain.cells()[flow.axis]};
}

/// Of the boundary that has one.
std::optional<PressureControl> pressure_control(const Scene& s, const Plan& p) {
  for (std::size_t i = 0; i < s.boundaries.size(); ++i) {
    const BoundaryScene& b = s.boundaries[i];
    if (!b.flow_rate) continue;
    const Opening o = opening(s, p, b);
    const double area = (o.end[0] - o.begin[0]) * (o.end[1] - o.begin[1]);
    const double face = s.box.dimension == 2 ? p.units.dx * s.box.depth : p.units.dx * p.units.dx;
    const double flow = *b.flow_rate / (face * p.units.velocity());
    return PressureControl(i, flow, in_time(p, b.ramp, b.frequency, b.table), area,
                           p.domain.cells()[axis_of(b.side)], b.pressure / p.units.pressure());
  }
  return {};
}

CellBox cells_of(const Scene& s, const Plan& p, const ObstacleScene& o) {
  CellBox box;
  auto& [from, to] = box;
  for (int axis = 0; axis < s.box.dimension; ++axis) {
    from[axis] = border(s, p, o.from[axis], axis, key_of(s, o, "from"));
    to[axis] = border(s, p, o.to[axis], axis, key_of(s, o, "to"));
    if (from[axis] < 0 || to[axis] > p.domain.cells()[axis] || from[axis] >= to[axis])
      throw InputError(key_of(s, o),
                       fmt::format("{:.6g} … {:.6g} m in {} is empty or outside the box",
                                   o.from[axis], o.to[axis], "xyz"[axis]),
                       "give its lower and upper corner");
  }
  return box;
}

/// In two dimensions it reaches beyond the one layer of cells, however thick that is.
MeshSolid solid_of(const Plan& p, const MeshScene& mesh) {
  TriangleMesh surface = *mesh.surface;
  for (Vec3& v : surface.vertices) {
    const bool upper = v.z() > 0.0;
    v = p.units.to_lattice_position(v);
    if (p.domain.dimension() == 2) v.z() = upper ? 2.0 : -1.0;
  }
  return {std::make_shared<const TriangleMesh>(std::move(surface)), mesh.hollow};
}

/// The wall of a drum: a shell around the circle or sphere.
MeshSolid drum_of(const Plan& p, const ObstacleScene& o) {
  const int d = p.domain.dimension();
  const Vec3 centre = p.units.to_lattice_position(o.centre);
  const double radius = 0.5 * o.diameter / p.units.dx;
  TriangleMesh surface = round_surface(centre, radius + kDrumWall, d);
  const TriangleMesh inside = round_surface(centre, radius, d);
  const auto n = static_cast<std::uint32_t>(surface.vertices.size());
  surface.vertices.insert(surface.vertices.end(), inside.vertices.begin(), inside.vertices.end());
  for (const auto& [a, b, c] : inside.triangles) surface.triangles.push_back({a + n, c + n, b + n});
  if (d == 2)
    for (Vec3& v : surface.vertices) v.z() = v.z() > 0.0 ? 2.0 : -1.0;
  return {std::make_shared<const TriangleMesh>(std::move(surface)), false};
}

/// A voxel is a whole number of cells wide, or a cell of voxels.
VoxelSolid voxels_of(const Scene& s, const Plan& p, const ObstacleScene& o) {
  const ImageScene& image = *o.image;
  VoxelSolid solid;
  solid.voxels = image.voxels;
  const double wide = image.voxel / p.units.dx, times = std::max(wide, 1.0 / wide);
  constexpr double most = 10000.0;  // of one in the other; boxes are no wider
  if (!(times <= most) || std::abs(times - std::round(times)) > 1e-6 * times)
    throw InputError(
        fmt::format("{} = {:.6g} m is {:.6g} cells", key_of(s, o, "voxel"), image.voxel, wide),
        fmt::format("take a cell that is a whole number of voxels, or a voxel of whole cells, {} "
                    "at most",
                    most));
  (wide > 1.0 ? solid.finer : solid.coarser) = static_cast<int>(std::lround(times));
  for (int k = 0; k < s.box.dimension; ++k) {
    const int voxels = image.voxels->size[k];
    if (voxels % solid.coarser != 0)
      throw InputError(key_of(s, o, "image"),
                       fmt::format("has {} voxels along {}, and {} of them make a cell", voxels,
                                   "xyz"[k], solid.coarser),
                       "cut it to whole cells with cut_from and cut_to");
    solid.at[k] = border(s, p, image.at[k], k, key_of(s, o, "at"));
    const int end = solid.at[k] + solid.cells(k), n = p.domain.cells()[k];
    if (solid.at[k] < 0 || end > n)
      throw InputError(key_of(s, o, "image"),
                       fmt::format("takes cells {} … {} along {}, the box has {}", solid.at[k], end,
                                   "xyz"[k], n),
                       "move it, or cut it with cut_from and cut_to");
  }
  return solid;
}

/// Velocity and pressure deviation of the initial state, lattice units, at a place in units of the
/// box.
struct Start {
  double drho;
  Vec3 u;
};
Start start(const InitialScene& i, const Units& units, double x, double y) {
  const Vec3 u = units.to_lattice_velocity(i.velocity);
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

void add_shape(const Scene& s, const Plan& p, const Geometry& shape, const ObstacleScene& o,
               Fluid& fluid) try {
  if (!o.motion) return fluid.add(shape);
  const auto pose = [units = p.units, motion = *o.motion](std::int64_t step) {
    return pose_in_cells(units, motion, step);
  };
  const bool steady = o.motion->surface_only && (o.motion->kind == MotionScene::Kind::Linear ||
                                                 o.motion->kind == MotionScene::Kind::Rotation);
  const auto drum =
      o.drum() ? std::optional(0.5 * o.diameter / p.units.dx + (steady ? 0.6 : 0.5) * kDrumWall)
               : std::nullopt;
  fluid.add(std::get<MeshSolid>(shape.shape), pose, drum, steady);
} catch (const std::invalid_argument& error) {
  throw InputError(key_of(s, o, "mesh"), error.what(),
                   "turn it outwards, or leave the inner shell out");
}

/// Refuses solids that leave nothing to compute. Collective.
void expect_fluid(const Scene& s, const Fluid& fluid) {
  constexpr double kClosed = 1.0 - 1e-6;
  const Cell3& n = fluid.cells().size;
  bool any = false;
  for (int z = 0; z < n[2] && !any; ++z)
    for (int y = 0; y < n[1] && !any; ++y)
      for (int x = 0; x < n[0] && !any; ++x) any = fluid.solid_fraction(x, y, z) < kClosed;
  if (fluid.ranks().max(any ? 1.0 : 0.0) > 0.0) return;
  throw InputError(s.file + ": obstacle",
                   "covers the whole box with the others: no cell is left to the fluid",
                   "compare sizes and places, in metres, with the box's; of an image look at "
                   "threshold and solid, of a mesh at its scale");
}

/// Gives the cells that a solid covers whole, and that send back all that arrives, the velocity of
/// their solid. They keep for ever what they hold among them, turned to and fro from step to step,
/// so they must not begin with a velocity of the fluid, nor with the half of a body force that
/// set_equilibrium takes off: the force never acts there, and a flux would change by it from step
/// to step.
void settle_solids(const Plan& p, Fluid& fluid) {
  if (!fluid.cover()) return;
  const SolidTermRows rows = solid_term_rows(p.kernel.solid_term, p.kernel.parameters.tau);
  const auto reflects = [](const SolidTermRows::Halves& h) {
    return h.odd.f == -2.0 && h.odd.fluid == 0.0;
  };
  const Cell3& n = fluid.cells().size;
  for (int z = 0; z < n[2]; ++z)
    for (int y = 0; y < n[1]; ++y)
      for (int x = 0; x < n[0]; ++x) {
        const auto [cover, velocity] = fluid.cover()->cell(x, y, z);
        if (cover < kWhole) continue;
        if (reflects(cover >= kWall ? rows.wall : cover >= kCore ? rows.core : rows.whole))
          fluid.set_equilibrium({x, y, z}, 1.0, velocity + 0.5 * fluid.body_force());
      }
}

}  // namespace

Pose pose_in_cells(const Units& units, const MotionScene& motion, std::int64_t step) {
  Pose pose = pose_at(motion, static_cast<double>(step) * units.dt);
  pose.pivot = units.to_lattice_position(pose.pivot);
  pose.shift = pose.shift / units.dx;
  pose.velocity = units.to_lattice_velocity(pose.velocity);
  pose.spin = units.to_lattice_spin(pose.spin);
  return pose;
}

std::vector<Body> obstacle_bodies(const Scene& s, const Plan& p, std::int64_t step) {
  std::vector<Body> bodies;
  for (const ObstacleScene& o : s.obstacles) {
    if (!o.body()) continue;
    Body& body = bodies.emplace_back(
        Body{-static_cast<std::int64_t>(bodies.size() + 1), p.units.to_lattice_position(o.centre),
             0.5 * o.diameter / p.units.dx, Vec3(), p.units.to_lattice_spin(o.spin), o.hollow});
    if (!o.motion) continue;
    const Pose pose = pose_in_cells(p.units, *o.motion, step);
    body.centre = pose.moved(body.centre);
    body.velocity = pose.velocity_at(body.centre);
    body.spin = pose.spin;
  }
  return bodies;
}

bool has_moving_bodies(const Scene& s) {
  return std::ranges::any_of(s.obstacles,
                             [](const ObstacleScene& o) { return o.body() && o.motion; });
}

std::vector<CellBox> obstacle_blocks(const Scene& s, const Plan& p) {
  std::vector<CellBox> blocks;
  for (const ObstacleScene& o : s.obstacles)
    if (o.block()) blocks.push_back(cells_of(s, p, o));
  return blocks;
}

std::vector<Geometry> obstacle_shapes(const Scene& s, const Plan& p) {
  std::vector<Geometry> shapes;
  for (const ObstacleScene& o : s.obstacles) {
    if (o.mesh) shapes.push_back({solid_of(p, *o.mesh)});
    if (o.image) shapes.push_back({voxels_of(s, p, o)});
    if (o.drum()) shapes.push_back({drum_of(p, o)});
  }
  return shapes;
}

Fluid make_fluid(const Scene& s, const Plan& p, const Decomposition& ranks) {
  Fluid fluid(ranks, p.kernel);
  for (const BoundaryScene& b : s.boundaries) add_boundary(s, p, b, fluid);
  for (int axis = 0; axis < s.box.dimension; ++axis)
    if (s.box.pressure_jump[axis] != 0.0)
      add_pressure_jump(p, axis, s.box.pressure_jump[axis], fluid);
  for (const CellBox& block : obstacle_blocks(s, p)) fluid.add_wall(block.from, block.to);
  const std::vector<Geometry> shapes = obstacle_shapes(s, p);
  std::size_t next = 0;
  for (const ObstacleScene& o : s.obstacles)
    if (!o.body() && !o.block()) add_shape(s, p, shapes[next++], o, fluid);
  if (p.scheme != SolidScheme::ImmersedMovingBoundary)
    fluid.use(make_scheme(p.scheme, p.domain, fluid.lattice(), s.numerics.spring_stiffness));
  const InTime force =
      in_time(p, s.fluid.body_force_ramp, s.fluid.body_force_frequency, s.fluid.body_force_table);
  if (force.changes_after(0)) fluid.vary_body_force(force);
  if (s.fluid.flow) fluid.hold_flow(flow_control(s, p));
  if (const auto control = pressure_control(s, p)) fluid.hold_flow(*control);
  if (fluid.has_solids()) {
    fluid.place(obstacle_bodies(s, p));
    expect_fluid(s, fluid);
  }
  const bool moving =
      p.kernel.solid_term != SolidTerm::None &&
      std::ranges::any_of(s.obstacles, [](const auto& o) { return o.motion.has_value(); });
  if (s.initial.kind == InitialScene::Kind::Rest && !p.kernel.force && !moving) return fluid;
  const Block& cells = ranks.cells();
  for (int z = 0; z < cells.size[2]; ++z)
    for (int y = 0; y < cells.size[1]; ++y)
      for (int x = 0; x < cells.size[0]; ++x) {
        const Start at = start(s.initial, p.units, (x + cells.begin[0] + 0.5) / p.domain.nx,
                               (y + cells.begin[1] + 0.5) / p.domain.ny);
        const bool inside = moving && fluid.solid_fraction(x, y, z) > 0.5;
        fluid.set_equilibrium({x, y, z}, 1.0 + at.drho,
                              inside ? fluid.cover()->cell(x, y, z).velocity : at.u);
      }
  settle_solids(p, fluid);
  return fluid;
}

}  // namespace lbm
