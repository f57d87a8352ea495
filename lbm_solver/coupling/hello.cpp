// SPDX-License-Identifier: GPL-2.0-or-later
#include "lbm_solver/coupling/hello.h"

#include <fmt/format.h>

#include <algorithm>

#include "lbm_solver/coupling/motion_words.h"
#include "lbm_solver/io/stl_file.h"
#include "protocol/wire/walls.h"

namespace lbm {

namespace {

/// A wall, also one that moves along itself, unless an opening takes the whole side.
protocol::SideWall wall_at(const Scene& s, SideName side) {
  if (s.box.sides[axis_of(side)] == SideKind::Periodic) return protocol::SideWall::None;
  auto wall = protocol::SideWall::Whole;
  for (const BoundaryScene& b : s.boundaries) {
    const bool moves_along =
        b.kind == BoundaryScene::Kind::Velocity && b.velocity[axis_of(side)] == 0.0;
    if (b.side != side || moves_along) continue;
    if (!b.from[0] && !b.from[1] && !b.to[0] && !b.to[1]) return protocol::SideWall::None;
    wall = protocol::SideWall::Partly;
  }
  return wall;
}

std::vector<const ObstacleScene*> meshes_of(const Scene& s) {
  std::vector<const ObstacleScene*> meshes;
  for (const ObstacleScene& o : s.obstacles)
    if (o.mesh) meshes.push_back(&o);
  return meshes;
}

/// The discs that a script can have as walls, in its words.
std::vector<std::string> discs_of(const Scene& s) {
  const double grain =
      s.particles ? 0.25 * (s.particles->diameter.lo + s.particles->diameter.hi) : 0;
  std::vector<std::string> discs;
  for (const ObstacleScene& o : s.obstacles)
    if (std::string wall = disc_wall_words(o, grain); s.box.dimension == 2 && !wall.empty())
      discs.push_back(std::move(wall));
  return discs;
}

/// The box around a mesh as it lies at a time.
std::string mesh_text(const ObstacleScene& o, double time) {
  TriangleMesh mesh = *o.mesh->surface;
  if (o.motion) {
    const Pose pose = pose_at(*o.motion, time);
    for (Vec3& v : mesh.vertices) v = pose.moved(v);
  }
  const auto [low, high] = bounds(mesh);
  return protocol::mesh_text({low.x(), low.y(), low.z()}, {high.x(), high.y(), high.z()});
}

void add_walls(const Scene& s, double time, protocol::Hello& h) {
  h.sides.emplace();
  for (int side = 0; side < 2 * s.box.dimension; ++side)
    (*h.sides)[side] = wall_at(s, static_cast<SideName>(side));
  const auto meshes = meshes_of(s);
  for (const ObstacleScene* o : meshes) h.bodies.push_back("obstacle: " + mesh_text(*o, time));
  std::size_t n = s.obstacles.size() - meshes.size();
  for (std::size_t i = 0; i < discs_of(s).size(); ++i, --n)
    h.bodies.push_back(fmt::format("disc{} (cylinder)", i + 1));
  if (n > 0) h.bodies.push_back(n == 1 ? "the scene's obstacle" : fmt::format("{} obstacles", n));
}

std::string mesh_file(const std::string& folder, std::size_t number) {
  return fmt::format("{}/mesh{}.stl", folder, number);
}

/// The walls that the script can build as the fluid has them, and how they move.
void add_shapes(const Scene& s, const std::string& folder, protocol::Hello& h) {
  const auto meshes = meshes_of(s);
  for (std::size_t i = 0; i < meshes.size(); ++i) {
    h.variables.push_back({fmt::format("mesh{}", i + 1), mesh_file(folder, i + 1)});
    const auto& motion = meshes[i]->motion;
    if (motion)
      h.variables.push_back({fmt::format("mesh{}_motion", i + 1), mesh_motion_words(*motion)});
  }
  const std::vector<std::string> discs = discs_of(s);
  for (std::size_t i = 0; i < discs.size(); ++i)
    h.variables.push_back({fmt::format("disc{}_wall", i + 1), discs[i]});
}

}  // namespace

void write_meshes(const Scene& s, const std::string& folder) {
  const auto meshes = meshes_of(s);
  for (std::size_t i = 0; i < meshes.size(); ++i)
    write_stl(mesh_file(folder, i + 1), *meshes[i]->mesh->surface);
}

void set_subdomain(const Units& units, const Domain& domain, const Block& cells,
                   protocol::Hello& hello) {
  for (int k = 0; k < domain.dimension(); ++k) {
    const int end = cells.begin[k] + cells.size[k];
    hello.subdomain_lo[k] = units.origin[k] + units.dx * cells.begin[k];
    hello.subdomain_hi[k] =
        end < domain.cells()[k] ? units.origin[k] + units.dx * end : hello.box_hi[k];
  }
}

protocol::Hello make_hello(const Scene& s, const Plan& plan, const RunStart& start,
                           const std::optional<Block>& cells) {
  const Vec3 top = s.box.origin + s.box.size;
  const double half_depth = 0.5 * s.box.depth;
  protocol::Hello h;
  h.role = protocol::Role::Fluid;
  h.program = "lbm";
  h.program_version = BPLBM_VERSION;
  const bool flat = s.box.dimension == 2;
  h.dimension = s.box.dimension;
  h.box_lo = {s.box.origin.x(), s.box.origin.y(), flat ? -half_depth : s.box.origin.z()};
  h.box_hi = {top.x(), top.y(), flat ? half_depth : top.z()};
  for (int k = 0; k < 3; ++k) h.periodic[k] = s.box.sides[k] == SideKind::Periodic;
  if (flat) h.periodic[2] = 1;
  h.depth = s.box.depth;
  h.gravity = {s.fluid.gravity.x(), s.fluid.gravity.y(), s.fluid.gravity.z()};
  h.buoyancy = s.coupling->buoyancy;
  h.first_interval = start.interval;
  h.schedule = s.coupling->overlapped ? protocol::Schedule::Overlapped : protocol::Schedule::Serial;
  if (s.checkpoint_every > 0.0) h.features |= protocol::kCheckpoints;
  h.step = plan.units.dt;
  h.fluid_steps = plan.fluid_steps;
  h.solid_steps = plan.substeps;
  const ParticleScene& p = *s.particles;
  h.radius = Range{0.5 * p.diameter.lo, 0.5 * p.diameter.hi};
  h.density = p.density;
  h.subdomain_lo = h.box_lo;
  h.subdomain_hi = h.box_hi;
  if (cells) set_subdomain(plan.units, plan.domain, *cells, h);
  add_walls(s, static_cast<double>(start.interval) * plan.interval(), h);
  h.reach = std::max(2.0, s.coupling->lubrication_range) * plan.units.dx;

  const auto number = [&h](const std::string& name, double value) {
    h.variables.push_back(
        {name, fmt::format("{}", value)});  // shortest text that reads back the same
  };
  const auto whole = [&h](const std::string& name, std::int64_t value) {
    h.variables.push_back({name, fmt::format("{}", value)});
  };
  const char* axis[] = {"x", "y", "z"};
  for (int k = 0; k < 3; ++k) {
    number(fmt::format("{}_lo", axis[k]), h.box_lo[k]);
    number(fmt::format("{}_hi", axis[k]), h.box_hi[k]);
    h.variables.push_back({fmt::format("boundary_{}", axis[k]), h.periodic[k] ? "p" : "f"});
    whole(fmt::format("walls_{}", axis[k]), h.periodic[k] ? 0 : 1);
  }
  const double g = s.fluid.gravity.norm();
  whole("dimension", s.box.dimension);
  number("depth", s.box.depth);
  number("gravity", g);
  number("gravity_x", g > 0.0 ? s.fluid.gravity.x() / g : 0.0);
  number("gravity_y", g > 0.0 ? s.fluid.gravity.y() / g : flat ? -1.0 : 0.0);
  number("gravity_z", g > 0.0 ? s.fluid.gravity.z() / g : flat ? 0.0 : -1.0);
  number("solid_step", plan.interval() / plan.substeps);
  whole("substeps", plan.substeps);
  whole("solid_steps_total", (plan.intervals - start.interval) * plan.substeps);
  whole("restart", start.interval > 0 ? 1 : 0);
  h.variables.push_back({"out_folder", start.out});
  h.variables.push_back({"checkpoint", start.checkpoint});
  h.variables.push_back({"restart_file", start.solid_part});
  number("coupling_timeout", s.coupling->timeout);
  number("diameter_min", p.diameter.lo);
  number("diameter_max", p.diameter.hi);
  number("density_min", p.density.lo);
  number("density_max", p.density.hi);
  for (std::size_t i = 0; i < p.start.size(); ++i) {
    number(fmt::format("particle{}_x", i + 1), p.start[i].x());
    number(fmt::format("particle{}_y", i + 1), p.start[i].y());
    if (!flat) number(fmt::format("particle{}_z", i + 1), p.start[i].z());
  }
  add_shapes(s, start.out, h);
  if (p.contact_stiffness) number("contact_stiffness", *p.contact_stiffness);
  for (const auto& [name, value] : p.variables) h.variables.push_back({name, value});
  return h;
}

}  // namespace lbm
