// SPDX-License-Identifier: GPL-2.0-or-later
#include "lbm_solver/io/scene_reader.h"

#include <fmt/format.h>

#include <cstdio>
#include <filesystem>
#include <fstream>

#include "lbm_solver/base/errors.h"
#include "lbm_solver/io/table_reader.h"

namespace lbm {
namespace {

toml::table parse(const std::string& file) {
  if (!std::filesystem::is_regular_file(file))
    throw InputError(file, "no such file",
                     "give the path of a scene, e.g. cases/settling_disc/scene.toml");
  try {
    return toml::parse_file(file);
  } catch (const toml::parse_error& e) {
    throw InputError(fmt::format("{}:{}", file, e.source().begin.line),
                     std::string(e.description()), "correct the TOML syntax");
  }
}

/// Lays `over` over `base`: tables are merged, everything else is replaced. Nodes are moved,
/// because a copy forgets the file and line it came from.
void overlay(toml::table& base, toml::table&& over) {
  for (auto&& [key, node] : over) {
    toml::node* below = base.get(key);
    if (below && below->is_table() && node.is_table())
      overlay(*below->as_table(), std::move(*node.as_table()));
    else
      node.visit(
          [&base, &name = key](auto& value) { base.insert_or_assign(name, std::move(value)); });
  }
}

SideKind side(TableReader& t, const std::string& key) {
  return t.choice_or(key, "wall", {"wall", "periodic"}) == "wall" ? SideKind::Wall
                                                                  : SideKind::Periodic;
}

BoxScene read_box(TableReader t) {
  BoxScene box;
  box.size = t.vector("size", "[m]");
  if (box.size.minCoeff() <= 0.0)
    t.fail("size", fmt::format("= [{}, {}] is not positive", box.size.x(), box.size.y()),
           "give the lengths of the box [x, y] in m");
  box.origin = t.vector_or("origin", {0.0, 0.0}, "[m]");
  box.depth = t.number_or("depth", 1.0, Bounds::positive(), "m");
  box.x = side(t, "sides_x");
  box.y = side(t, "sides_y");
  box.pressure_jump = t.vector_or("pressure_jump", {0.0, 0.0}, "[Pa]");
  const SideKind kinds[] = {box.x, box.y};
  for (int k = 0; k < 2; ++k)
    if (box.pressure_jump[k] != 0.0 && kinds[k] == SideKind::Wall)
      t.fail("pressure_jump", "acts across sides that are not periodic",
             "make the sides periodic, or give [[boundary]] pressures");
  t.finish();
  return box;
}

FluidScene read_fluid(TableReader t) {
  FluidScene fluid;
  fluid.density = t.number("density", Bounds::positive(), "kg/m³");
  fluid.viscosity = t.number("kinematic_viscosity", Bounds::positive(), "m²/s");
  fluid.gravity = t.vector_or("gravity", {0.0, 0.0}, "[m/s²]");
  fluid.body_force = t.vector_or("body_force", {0.0, 0.0}, "[m/s²]");
  fluid.velocity_scale = t.number("velocity_scale", Bounds::positive(), "m/s");
  t.finish();
  return fluid;
}

NumericsScene read_numerics(TableReader t) {
  NumericsScene n;
  n.cell = t.optional_number("cell", Bounds::positive(), "m");
  n.cells_per_diameter = t.optional_number("cells_per_diameter", {2.0, 10000.0}, "cells");
  if (n.cell.has_value() == n.cells_per_diameter.has_value())
    t.fail("cell", n.cell ? "stands beside cells_per_diameter" : "is missing",
           "give either cell [m] or cells_per_diameter");
  n.time_step = t.optional_number("time_step", Bounds::positive(), "s");
  n.collision = t.choice_or("collision", n.collision,
                            {"auto", "bgk", "trt", "central_moment", "recursive_regularised"});
  n.solid_term = t.choice_or("solid_term", n.solid_term,
                             {"auto", "layered_holdych", "layered_noble_torczynski", "holdych",
                              "noble_torczynski", "superposition"});
  n.scheme =
      t.choice_or("scheme", n.scheme,
                  {"auto", "immersed_moving_boundary", "bounce_back", "interpolated_bounce_back",
                   "implicit_immersed_boundary", "spring_immersed_boundary"});
  n.spring_stiffness = t.number_or("spring_stiffness", n.spring_stiffness, Bounds::positive(), "");
  n.weight_is_fraction = t.choice_or("weight", "viscous", {"viscous", "fraction"}) == "fraction";
  n.smagorinsky = t.number_or("smagorinsky", 0.0, {0.0, 1.0}, "");
  n.magic = t.number_or("magic", n.magic, {1e-6, 10.0}, "");
  t.finish();
  return n;
}

ParticleScene read_particles(TableReader t) {
  ParticleScene p;
  p.diameter = t.range("diameter", Bounds::positive(), "m");
  p.density = t.range("density", Bounds::positive(), "kg/m³");
  p.hydraulic_ratio = t.numbers_or("hydraulic_ratio", p.hydraulic_ratio, {0.1, 1.0}, "");
  p.start = t.vectors_or_none("start", "[m]");
  p.contact_stiffness = t.optional_number("contact_stiffness", Bounds::positive(), "N/m");
  p.variables = t.optional_table("variables").all_as_text();
  t.finish();
  return p;
}

CouplingScene read_coupling(TableReader t) {
  CouplingScene c;
  c.fluid_steps = t.optional_integer("fluid_steps", 1).value_or(1);
  c.substeps = t.optional_integer("substeps", 1);
  c.inner_inertia = t.flag_or("inner_inertia", true);
  const std::string by = t.choice_or("buoyancy", "fluid", {"fluid", "solid", "none"});
  c.buoyancy = by == "fluid"   ? protocol::Buoyancy::ByFluid
               : by == "solid" ? protocol::Buoyancy::BySolid
                               : protocol::Buoyancy::None;
  c.virtual_mass = t.optional_number("virtual_mass", {0.0, 100.0}, "");
  c.lubrication_range = t.number_or("lubrication_range", 0.0, {0.0, 10.0}, "cells");
  c.overlapped = t.choice_or("schedule", "serial", {"serial", "overlapped"}) == "overlapped";
  c.timeout = t.number_or("timeout", c.timeout, Bounds::positive(), "s");
  t.finish();
  return c;
}

BoundaryScene read_boundary(TableReader t, const BoxScene& box) {
  using Kind = BoundaryScene::Kind;
  BoundaryScene b;
  if (!t.has("side")) t.fail("side", "is missing", "give left, right, bottom or top");
  const std::string side = t.choice_or("side", "", {"left", "right", "bottom", "top"});
  b.side = side == "left"     ? SideName::Left
           : side == "right"  ? SideName::Right
           : side == "bottom" ? SideName::Bottom
                              : SideName::Top;
  const bool vertical = b.side == SideName::Left || b.side == SideName::Right;
  if ((vertical ? box.x : box.y) == SideKind::Periodic)
    t.fail("side", "= \"" + side + "\" is periodic", "make the box's sides there \"wall\"");
  if (!t.has("kind"))
    t.fail("kind", "is missing", "give velocity, moving_wall, pressure or outflow");
  const std::string kind =
      t.choice_or("kind", "", {"velocity", "moving_wall", "pressure", "outflow"});
  b.kind = kind == "pressure" ? Kind::Pressure : kind == "outflow" ? Kind::Outflow : Kind::Velocity;
  const int along = vertical ? 1 : 0;
  const double lo = box.origin[along], hi = lo + box.size[along];
  b.from = t.optional_number("from", {lo, hi}, "m");
  b.to = t.optional_number("to", {b.from.value_or(lo), hi}, "m");
  if (b.kind == Kind::Velocity) {
    b.velocity = t.vector("velocity", "[m/s]");
    b.parabolic = t.choice_or("profile", "uniform", {"uniform", "parabolic"}) == "parabolic";
    b.frequency = t.number_or("frequency", 0.0, Bounds::non_negative(), "Hz");
    if (kind == "moving_wall" && b.velocity[vertical ? 0 : 1] != 0.0)
      t.fail("velocity", "has a component through the wall", "use kind = \"velocity\"");
  } else {
    b.pressure = t.number_or("pressure", 0.0, {}, "Pa");
  }
  b.ramp = t.number_or("ramp", 0.0, Bounds::non_negative(), "s");
  t.finish();
  return b;
}

ObstacleScene read_obstacle(TableReader t) {
  ObstacleScene o;
  o.disc = t.has("centre");
  if (o.disc) {
    o.centre = t.vector("centre", "[m]");
    o.diameter = t.number("diameter", Bounds::positive(), "m");
    o.hollow = t.flag_or("hollow", false);
    o.spin = t.number_or("spin", 0.0, {}, "rad/s");
  } else {
    o.from = t.vector("from", "[m], or centre and diameter of a disc");
    o.to = t.vector("to", "[m]");
  }
  t.finish();
  return o;
}

/// Discs at rest from a table `x,y,diameter` in m, beside the scene.
void read_grains(TableReader t, const std::string& scene_file,
                 std::vector<ObstacleScene>& obstacles) {
  const std::string name = t.text_or("file", "");
  t.finish();
  if (name.empty()) return;
  const auto path = std::filesystem::path(scene_file).parent_path() / name;
  std::ifstream table(path);
  if (!table) t.fail("file", "= \"" + name + "\" cannot be read", "put it beside the scene");
  std::string line;
  std::getline(table, line);
  if (line != "x,y,diameter")
    t.fail("file", "begins with '" + line + "'", "the first line is x,y,diameter (in m)");
  for (int number = 2; std::getline(table, line); ++number) {
    ObstacleScene o;
    o.disc = o.grain = true;
    char rest = 0;
    if (std::sscanf(line.c_str(), "%lf,%lf,%lf%c", &o.centre.x(), &o.centre.y(), &o.diameter,
                    &rest) != 3 ||
        !(o.diameter > 0.0))
      t.fail("file", fmt::format("line {}: '{}' is not three numbers", number, line),
             "give x,y,diameter in m");
    obstacles.push_back(o);
  }
}

InitialScene read_initial(TableReader t) {
  using Kind = InitialScene::Kind;
  InitialScene i;
  const std::string kind =
      t.choice_or("kind", "rest", {"rest", "uniform", "channel", "taylor_green", "shear_layer"});
  i.kind = kind == "uniform"        ? Kind::Uniform
           : kind == "channel"      ? Kind::Channel
           : kind == "taylor_green" ? Kind::TaylorGreen
           : kind == "shear_layer"  ? Kind::ShearLayer
                                    : Kind::Rest;
  i.velocity = t.vector_or("velocity", {0.0, 0.0}, "[m/s]");
  i.sharpness = t.number_or("sharpness", i.sharpness, Bounds::positive(), "");
  i.perturbation = t.number_or("perturbation", i.perturbation, Bounds::non_negative(), "");
  t.finish();
  return i;
}

}  // namespace

Scene read_scene(const std::vector<std::string>& files) {
  toml::table merged = parse(files.front());
  for (std::size_t i = 1; i < files.size(); ++i) overlay(merged, parse(files[i]));
  TableReader root(merged, "", files.front());
  Scene scene;
  scene.file = files.front();
  scene.title = root.text_or("title", std::filesystem::path(files.front()).stem().string());
  scene.box = read_box(root.table("box"));
  scene.fluid = read_fluid(root.table("fluid"));
  scene.numerics = read_numerics(root.table("numerics"));
  if (root.has("particles")) scene.particles = read_particles(root.table("particles"));
  if (root.has("coupling")) scene.coupling = read_coupling(root.table("coupling"));
  if (scene.coupling && !scene.particles)
    root.fail("particles", "is missing", "[coupling] needs a table [particles]");
  TableReader run = root.table("run");
  scene.end_time = run.number("end_time", Bounds::positive(), "s");
  scene.steady_below = run.number_or("steady_below", 0.0, Bounds::non_negative(), "");
  scene.checkpoint_every = run.number_or("checkpoint_every", 0.0, Bounds::non_negative(), "s");
  run.finish();
  for (const TableReader& t : root.tables("boundary"))
    scene.boundaries.push_back(read_boundary(t, scene.box));
  for (const TableReader& t : root.tables("obstacle")) scene.obstacles.push_back(read_obstacle(t));
  read_grains(root.optional_table("grains"), files.front(), scene.obstacles);
  scene.initial = read_initial(root.optional_table("initial"));
  TableReader output = root.optional_table("output");
  scene.output.fields_every = output.number_or("fields_every", 0.0, Bounds::non_negative(), "s");
  scene.output.probe_every = output.number_or("probe_every", 0.0, Bounds::non_negative(), "s");
  scene.output.points = output.vectors_or_none("points", "[m]");
  output.finish();
  root.finish();
  return scene;
}

}  // namespace lbm
