// SPDX-License-Identifier: GPL-2.0-or-later
#include "lbm_solver/coupling/handshake.h"

#include <fmt/core.h>

#include <algorithm>

#include "lbm_solver/base/mesh_cut.h"
#include "lbm_solver/coupling/motion_words.h"
#include "lbm_solver/io/stl_file.h"
#include "lbm_solver/solver/motion_check.h"
#include "protocol/wire/walls.h"

namespace lbm {

namespace {

using Variables = std::vector<protocol::Variable>;

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

/// As io/obstacle_reader calls it.
bool is_cylinder(const MeshScene& mesh) {
  return mesh.file == "of a cylinder";
}

/// The farther of a place and a side of the box, outwards along `sign`; the side where the place
/// lies beyond it by round-off alone.
double beyond(double place, double side, double sign, double size) {
  constexpr double kRoundOff = 1e-9;  // of the box
  return sign * (place - side) > kRoundOff * size ? place : side;
}

/// The surface of a mesh as the solid's program gets it. LIGGGHTS stops where a triangle's middle
/// lies beyond the box, where one is long and thin, and where one reaches farther than once around
/// a periodic side, as the layer of two dimensions is: what stands there is cut at the box, beyond
/// which no grain is, long triangles are parted, and a block of a thin layer is made of short
/// pieces.
TriangleMesh offered_mesh(const Scene& s, const ObstacleScene& o) {
  if (!s.coupling) return *o.mesh->surface;
  const TriangleMesh whole =
      is_cylinder(*o.mesh) ? of_fewer_sides(*o.mesh->surface) : *o.mesh->surface;
  auto [low, high] = bounds(whole);
  if (s.box.dimension == 3 && (!o.motion || o.motion->surface_only)) {
    low = s.box.origin;
    high = low + s.box.size;
  } else if (const double room = reach_in_layer(s);
             s.box.dimension == 2 && room > 0.0 && largest_reach(whole) > room) {
    return short_walls(whole, room);
  } else {  // the box, and the mesh where it lies beyond
    for (int k = 0; k < s.box.dimension; ++k) {
      low[k] = beyond(low[k], s.box.origin[k], -1.0, s.box.size[k]);
      high[k] = beyond(high[k], s.box.origin[k] + s.box.size[k], 1.0, s.box.size[k]);
    }
  }
  TriangleMesh part = clipped(whole, low, high);
  for (int k = 0; k < s.box.dimension; ++k)
    if (s.box.sides[k] == SideKind::Periodic)
      part = without_ends(part, k, s.box.origin[k], s.box.origin[k] + s.box.size[k]);
  return part;
}

/// The box around a mesh as it lies at a time.
std::string mesh_text(const Scene& s, const ObstacleScene& o, double time) {
  TriangleMesh mesh = offered_mesh(s, o);
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
  for (const ObstacleScene* o : meshes)
    h.bodies.push_back("obstacle: " + mesh_text(s, *o, time) +
                       (o->motion ? protocol::motion_text(true) : ""));
  std::size_t n = s.obstacles.size() - meshes.size();
  for (std::size_t i = 0; i < discs_of(s).size(); ++i, --n)
    h.bodies.push_back(fmt::format("disc{} (cylinder)", i + 1));
  if (n > 0) h.bodies.push_back(n == 1 ? "the scene's obstacle" : fmt::format("{} obstacles", n));
}

std::string mesh_file(const std::string& folder, std::size_t number) {
  return fmt::format("{}/mesh{}.stl", folder, number);
}

/// The walls that the script can build as the fluid has them, and how they move.
Variables shape_variables(const Scene& s, const std::string& folder) {
  Variables all;
  const auto meshes = meshes_of(s);
  for (std::size_t i = 0; i < meshes.size(); ++i) {
    all.push_back({fmt::format("mesh{}", i + 1), mesh_file(folder, i + 1)});
    const auto& motion = meshes[i]->motion;
    if (motion) all.push_back({fmt::format("mesh{}_motion", i + 1), mesh_motion_words(*motion)});
  }
  const std::vector<std::string> discs = discs_of(s);
  for (std::size_t i = 0; i < discs.size(); ++i)
    all.push_back({fmt::format("disc{}_wall", i + 1), discs[i]});
  return all;
}

void add_box(const Scene& s, protocol::Hello& h) {
  const Vec3 top = s.box.origin + s.box.size;
  const double half_depth = 0.5 * s.box.depth;
  const bool flat = s.box.dimension == 2;
  h.dimension = s.box.dimension;
  h.box_lo = {s.box.origin.x(), s.box.origin.y(), flat ? -half_depth : s.box.origin.z()};
  h.box_hi = {top.x(), top.y(), flat ? half_depth : top.z()};
  for (int k = 0; k < 3; ++k) h.periodic[k] = s.box.sides[k] == SideKind::Periodic;
  if (flat) h.periodic[2] = 1;
  h.depth = s.box.depth;
}

/// What both sides must agree on beside the box.
void add_agreement(const Scene& s, const Plan& plan, const RunStart& start, protocol::Hello& h) {
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
}

/// The cells of this rank, and how far beyond them a particle still matters to it.
void add_subdomain(const Scene& s, const Plan& plan, const std::optional<Block>& cells,
                   protocol::Hello& h) {
  h.subdomain_lo = h.box_lo;
  h.subdomain_hi = h.box_hi;
  if (cells) set_subdomain(plan.units, plan.domain, *cells, h);
  h.reach = std::max(2.0, s.coupling->lubrication_range) * plan.units.dx;
}

/// A number as the shortest text that reads back the same.
protocol::Variable number(const std::string& name, double value) {
  return {name, fmt::format("{}", value)};
}

protocol::Variable whole(const std::string& name, std::int64_t value) {
  return {name, fmt::format("{}", value)};
}

Variables box_variables(const Scene& s, const protocol::Hello& h) {
  Variables all;
  const char* axis[] = {"x", "y", "z"};
  for (int k = 0; k < 3; ++k) {
    all.push_back(number(fmt::format("{}_lo", axis[k]), h.box_lo[k]));
    all.push_back(number(fmt::format("{}_hi", axis[k]), h.box_hi[k]));
    all.push_back({fmt::format("boundary_{}", axis[k]), h.periodic[k] ? "p" : "f"});
    all.push_back(whole(fmt::format("walls_{}", axis[k]), h.periodic[k] ? 0 : 1));
  }
  all.push_back(whole("dimension", s.box.dimension));
  all.push_back(number("depth", s.box.depth));
  return all;
}

/// Gravity as its strength and its direction, which is downwards where there is none.
Variables gravity_variables(const Scene& s) {
  const Vec3& gravity = s.fluid.gravity;
  const double g = gravity.norm();
  const bool flat = s.box.dimension == 2;
  const Vec3 down = g > 0.0 ? Vec3(gravity / g) : Vec3(0.0, flat ? -1.0 : 0.0, flat ? 0.0 : -1.0);
  return {number("gravity", g), number("gravity_x", down.x()), number("gravity_y", down.y()),
          number("gravity_z", down.z())};
}

Variables run_variables(const Scene& s, const Plan& plan, const RunStart& start) {
  return {number("solid_step", plan.interval() / plan.substeps),
          whole("substeps", plan.substeps),
          whole("solid_steps_total", (plan.intervals - start.interval) * plan.substeps),
          whole("restart", start.interval > 0 ? 1 : 0),
          {"out_folder", start.out},
          {"checkpoint", start.checkpoint},
          {"restart_file", start.solid_part},
          number("coupling_timeout", s.coupling->timeout)};
}

Variables particle_variables(const ParticleScene& p, int dimension) {
  Variables all{number("diameter_min", p.diameter.lo), number("diameter_max", p.diameter.hi),
                number("density_min", p.density.lo), number("density_max", p.density.hi)};
  for (std::size_t i = 0; i < p.start.size(); ++i) {
    all.push_back(number(fmt::format("particle{}_x", i + 1), p.start[i].x()));
    all.push_back(number(fmt::format("particle{}_y", i + 1), p.start[i].y()));
    if (dimension == 3) all.push_back(number(fmt::format("particle{}_z", i + 1), p.start[i].z()));
  }
  return all;
}

void append(Variables& all, const Variables& more) {
  all.insert(all.end(), more.begin(), more.end());
}

}  // namespace

void write_meshes(const Scene& s, const std::string& folder) {
  const auto meshes = meshes_of(s);
  for (std::size_t i = 0; i < meshes.size(); ++i)
    write_stl(mesh_file(folder, i + 1), offered_mesh(s, *meshes[i]));
}

void set_subdomain(const Units& units, const Domain& domain, const Block& cells,
                   protocol::Hello& handshake) {
  for (int k = 0; k < domain.dimension(); ++k) {
    const int end = cells.begin[k] + cells.size[k];
    handshake.subdomain_lo[k] = units.origin[k] + units.dx * cells.begin[k];
    handshake.subdomain_hi[k] =
        end < domain.cells()[k] ? units.origin[k] + units.dx * end : handshake.box_hi[k];
  }
}

protocol::Hello make_handshake(const Scene& s, const Plan& plan, const RunStart& start,
                               const std::optional<Block>& cells) {
  protocol::Hello h;
  h.role = protocol::Role::Fluid;
  h.program = "lbm";
  h.program_version = BPLBM_VERSION;
  add_box(s, h);
  add_agreement(s, plan, start, h);
  add_subdomain(s, plan, cells, h);
  add_walls(s, static_cast<double>(start.interval) * plan.interval(), h);
  h.variables = box_variables(s, h);
  append(h.variables, gravity_variables(s));
  append(h.variables, run_variables(s, plan, start));
  append(h.variables, particle_variables(*s.particles, s.box.dimension));
  append(h.variables, shape_variables(s, start.out));
  if (s.particles->contact_stiffness)
    h.variables.push_back(number("contact_stiffness", *s.particles->contact_stiffness));
  for (const auto& [name, value] : s.particles->variables) h.variables.push_back({name, value});
  return h;
}

}  // namespace lbm
