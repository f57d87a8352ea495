// SPDX-License-Identifier: GPL-2.0-or-later
#include "lbm_solver/io/scene_reader.h"

#include <fmt/format.h>
#include <toml++/toml.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "lbm_solver/base/errors.h"
#include "lbm_solver/io/boundary_reader.h"
#include "lbm_solver/io/fluid_reader.h"
#include "lbm_solver/io/grains_reader.h"
#include "lbm_solver/io/hdf5_files.h"
#include "lbm_solver/io/obstacle_reader.h"
#include "lbm_solver/io/output_reader.h"
#include "lbm_solver/io/script_variables.h"
#include "lbm_solver/io/table_reader.h"
#include "lbm_solver/lattice/lattice.h"
#include "protocol/program/input_file.h"

namespace lbm {
namespace {

constexpr std::uintmax_t kLargestScene = 16'000'000;  // bytes

toml::table parse(const std::string& file) {
  if (const auto problem = protocol::why_unreadable(file, kLargestScene); !problem.empty())
    throw InputError(file, problem,
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
  const int d = box.dimension = t.length_of("size") == 3 ? 3 : 2;
  box.size = t.vector("size", d, "[m], or three lengths for a scene in three dimensions");
  for (int a = 0; a < d; ++a)
    if (!(box.size[a] > 0.0))
      t.fail("size", fmt::format("holds {}, which is not positive", box.size[a]),
             "give the lengths of the box [x, y] or [x, y, z] in m");
  box.origin = t.vector_or_zero("origin", d, "[m]");
  if (d == 3 && t.has("depth")) t.fail("depth", "is of no use in three dimensions", "leave it out");
  box.depth = t.number_or("depth", 1.0, Bounds::positive(), "m");
  box.sides[0] = side(t, "sides_x");
  box.sides[1] = side(t, "sides_y");
  if (d == 3) box.sides[2] = side(t, "sides_z");
  box.pressure_jump = t.vector_or_zero("pressure_jump", d, "[Pa]");
  for (int k = 0; k < d; ++k)
    if (box.pressure_jump[k] != 0.0 && box.sides[k] == SideKind::Wall)
      t.fail("pressure_jump", "acts across sides that are not periodic",
             "make the sides periodic, or give [[boundary]] pressures");
  t.finish();
  return box;
}

template <Choice E>
E choice_or(TableReader& t, const char* key, E fallback) {
  return from_name<E>(t.choice_or(key, name_of(fallback), names_of(choices<E>())));
}

/// Nothing where the scene says "auto".
template <Choice E>
std::optional<E> choice_or_auto(TableReader& t, const char* key,
                                const std::vector<E>& known = choices<E>()) {
  std::vector<std::string> names = names_of(known);
  names.insert(names.begin(), "auto");
  const std::string name = t.choice_or(key, "auto", names);
  return name == "auto" ? std::nullopt : std::optional(from_name<E>(name));
}

std::vector<VelocitySet> sets_of(int dimension) {
  std::vector<VelocitySet> sets = choices<VelocitySet>();
  std::erase_if(sets, [dimension](VelocitySet set) { return lattice(set).D != dimension; });
  return sets;
}

NumericsScene read_numerics(TableReader t, int d) {
  NumericsScene n;
  n.cell = t.optional_number("cell", Bounds::positive(), "m");
  n.cells_per_diameter = t.optional_number("cells_per_diameter", {2.0, 10000.0}, "cells");
  if (n.cell.has_value() == n.cells_per_diameter.has_value())
    t.fail("cell", n.cell ? "stands beside cells_per_diameter" : "is missing",
           "give either cell [m] or cells_per_diameter");
  n.time_step = t.optional_number("time_step", Bounds::positive(), "s");
  n.lattice = choice_or_auto(t, "lattice", sets_of(d));
  n.precision = choice_or(t, "precision", n.precision);
  n.collision = choice_or_auto<CollisionOperator>(t, "collision");
  n.solid_term = choice_or_auto<SolidTerm>(t, "solid_term");
  n.scheme = choice_or_auto<SolidScheme>(t, "scheme");
  n.spring_stiffness = t.number_or("spring_stiffness", n.spring_stiffness, Bounds::positive(), "");
  n.weight = choice_or_auto<WeightRule>(t, "weight");
  n.equal_work = t.choice_or("blocks", "equal", {"equal", "equal_work"}) == "equal_work";
  n.waiting_bound = t.number_or("waiting_bound", n.waiting_bound, {0.0, 1.0}, "");
  n.smagorinsky = t.number_or("smagorinsky", 0.0, {0.0, 1.0}, "");
  n.eddies = choice_or(t, "eddy_viscosity", n.eddies);
  n.magic = t.optional_number("magic", {1e-6, 10.0}, "");
  t.finish();
  return n;
}

std::map<std::string, std::string> read_variables(TableReader t) {
  std::map<std::string, std::string> variables = t.all_as_text();
  for (const auto& [name, value] : variables) {
    if (is_reserved_variable(name))
      t.fail(name, "is a name that the programs give a value of their own",
             "choose another name; lbm check --liggghts-vars lists those that are taken");
    if (const auto problem = why_no_variable(name, value); !problem.empty())
      t.fail(
          name, "= \"" + value + "\" " + problem,
          "a script variable is a word of letters, digits and _, its value a number or one word of "
          "these and . , : / + - * =");
  }
  return variables;
}

ParticleScene read_particles(TableReader t, int d) {
  ParticleScene p;
  p.diameter = t.range("diameter", Bounds::positive(), "m");
  p.density = t.range("density", Bounds::positive(), "kg/m³");
  p.hydraulic_ratio = t.numbers_or("hydraulic_ratio", p.hydraulic_ratio, {0.1, 1.0}, "");
  p.start = t.vectors_or_none("start", d, "[m]");
  p.contact_stiffness = t.optional_number("contact_stiffness", Bounds::positive(), "N/m");
  p.variables = read_variables(t.optional_table("variables"));
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
  c.carry_weight = t.flag_or("carry_weight", false);
  c.lubrication_range = t.number_or("lubrication_range", 0.0, {0.0, 10.0}, "cells");
  c.overlapped = t.choice_or("schedule", "serial", {"serial", "overlapped"}) == "overlapped";
  c.timeout = t.number_or("timeout", c.timeout, Bounds::positive(), "s");
  c.connect_timeout = t.number_or("connect_timeout", c.connect_timeout, Bounds::positive(), "s");
  t.finish();
  return c;
}

InitialScene read_initial(TableReader t, int d) {
  using Kind = InitialScene::Kind;
  InitialScene i;
  const std::string kind =
      t.choice_or("kind", "rest", {"rest", "uniform", "channel", "taylor_green", "shear_layer"});
  i.kind = kind == "uniform"        ? Kind::Uniform
           : kind == "channel"      ? Kind::Channel
           : kind == "taylor_green" ? Kind::TaylorGreen
           : kind == "shear_layer"  ? Kind::ShearLayer
                                    : Kind::Rest;
  i.velocity = t.vector_or_zero("velocity", d, "[m/s]");
  i.sharpness = t.number_or("sharpness", i.sharpness, Bounds::positive(), "");
  i.perturbation = t.number_or("perturbation", i.perturbation, Bounds::non_negative(), "");
  t.finish();
  return i;
}

Scene read_tables(const toml::table& merged, const std::vector<std::string>& files,
                  KeyNotes* keys) {
  Scene scene;
  TableReader root(merged, "", files.front(), &scene.settings, keys);
  scene.file = fmt::format("{}", fmt::join(files, " + "));
  scene.title = root.text_or("title", std::filesystem::path(files.front()).stem().string());
  scene.box = read_box(root.table("box"));
  const int d = scene.box.dimension;
  scene.fluid = read_fluid(root.table("fluid"), d, files.front());
  scene.numerics = read_numerics(root.table("numerics"), d);
  if (root.has("particles")) scene.particles = read_particles(root.table("particles"), d);
  if (root.has("coupling")) scene.coupling = read_coupling(root.table("coupling"));
  if (scene.coupling && !scene.particles)
    root.fail("particles", "is missing", "[coupling] needs a table [particles]");
  TableReader run = root.table("run");
  scene.end_time = run.number("end_time", Bounds::positive(), "s");
  scene.steady_below = run.number_or("steady_below", 0.0, Bounds::non_negative(), "");
  scene.checkpoint_every = run.number_or("checkpoint_every", 0.0, Bounds::non_negative(), "s");
  expect_hdf5(run, "checkpoint_every", scene.checkpoint_every > 0.0);
  run.finish();
  for (const TableReader& t : root.tables("boundary"))
    scene.boundaries.push_back(read_boundary(t, scene.box, files.front()));
  for (const TableReader& t : root.tables("obstacle"))
    scene.obstacles.push_back(read_obstacle(t, files.front(), scene.box));
  read_grains(root.optional_table("grains"), files.front(), d, scene.obstacles);
  scene.initial = read_initial(root.optional_table("initial"), d);
  settle_viscosity(root, scene);
  scene.output = read_output(root, scene.box);
  root.finish();
  return scene;
}

}  // namespace

Scene read_scene(const std::vector<std::string>& files) {
  toml::table merged = parse(files.front());
  for (std::size_t i = 1; i < files.size(); ++i) overlay(merged, parse(files[i]));
  return read_tables(merged, files, nullptr);
}

double connect_timeout_in(const std::vector<std::string>& files) {
  double seconds = CouplingScene().connect_timeout;
  for (const std::string& file : files) try {
      seconds = toml::parse_file(file)["coupling"]["connect_timeout"].value_or(seconds);
    } catch (const toml::parse_error&) {  // read_scene says it
    }
  return std::isfinite(seconds) && seconds > 0.0 ? seconds : CouplingScene().connect_timeout;
}

void note_keys(const std::string& scene, KeyNotes& keys) {
  read_tables(toml::parse(scene), {"the reader's own example"}, &keys);
}

}  // namespace lbm
