// SPDX-License-Identifier: GPL-2.0-or-later
#include "lbm_solver/io/scene_reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>

#include "lbm_solver/base/errors.h"
#include "lbm_solver/io/obstacle_reader.h"
#include "lbm_solver/io/profile_reader.h"
#include "lbm_solver/io/script_variables.h"
#include "lbm_solver/io/table_reader.h"
#include "lbm_solver/viscosity/viscosity_law.h"
#include "protocol/program/checksum.h"
#include "protocol/program/input_file.h"

namespace lbm {
namespace {

constexpr std::uintmax_t kLargestScene = 16'000'000, kLargestTable = 256'000'000;  // bytes

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

using ViscosityModel = ViscosityScene::Model;

/// Keys of the laws that a model has not.
void refuse_other_keys(TableReader& t, ViscosityModel model) {
  const bool newtonian = model == ViscosityModel::Newtonian || model == ViscosityModel::Smagorinsky;
  const bool yields = model == ViscosityModel::Bingham || model == ViscosityModel::HerschelBulkley;
  const bool carreau = model == ViscosityModel::Carreau;
  const auto refuse = [&](bool known, std::initializer_list<const char*> keys) {
    for (const char* key : keys)
      if (!known && t.has(key))
        t.fail(key, "has no meaning with model = \"" + name_of(model) + "\"", "leave it out");
  };
  refuse(!newtonian, {"nu_min", "nu_max", "shear_rate"});
  refuse(!newtonian && !carreau, {"consistency"});
  refuse(!newtonian && model != ViscosityModel::Bingham, {"index"});
  refuse(yields, {"yield_stress", "regularisation"});
  refuse(carreau, {"time_constant"});
}

ViscosityScene read_viscosity(TableReader t) {
  ViscosityScene v;
  std::vector<std::string> names;
  for (const ViscosityModel model : known_viscosities()) names.push_back(name_of(model));
  const std::string name = t.choice_or("model", names.front(), names);
  v.model = known_viscosities()[std::ranges::find(names, name) - names.begin()];
  refuse_other_keys(t, v.model);
  const bool newtonian =
      v.model == ViscosityModel::Newtonian || v.model == ViscosityModel::Smagorinsky;
  const bool carreau = v.model == ViscosityModel::Carreau;
  if (!newtonian && !carreau) v.consistency = t.number("consistency", Bounds::positive(), "Pa sⁿ");
  if (!newtonian && v.model != ViscosityModel::Bingham) v.index = t.number("index", {0.1, 2.0}, "");
  if (carreau) v.time_constant = t.number("time_constant", Bounds::positive(), "s");
  if (v.model == ViscosityModel::Bingham || v.model == ViscosityModel::HerschelBulkley) {
    v.yield_stress = t.number("yield_stress", Bounds::positive(), "Pa");
    if (t.choice_or("regularisation", "bi_viscosity", {"bi_viscosity", "papanastasiou"}) !=
        "bi_viscosity")
      v.regularisation = ViscosityScene::Regularisation::Papanastasiou;
  }
  v.nu_min = t.optional_number("nu_min", Bounds::positive(), "m²/s");
  v.nu_max = t.optional_number("nu_max", Bounds::positive(), "m²/s");
  v.shear_rate = t.optional_number("shear_rate", Bounds::positive(), "1/s");
  if (carreau && !(v.nu_min && v.nu_max))
    t.fail(v.nu_min ? "nu_max" : "nu_min", "is missing",
           "Carreau's law goes from nu_max at rest to nu_min at high shear rates");
  if (v.nu_min && v.nu_max && *v.nu_min >= *v.nu_max)
    t.fail("nu_min",
           fmt::format("= {:.6g} m²/s is not below nu_max = {:.6g} m²/s", *v.nu_min, *v.nu_max),
           "give nu_min < nu_max");
  v.smagorinsky = t.number_or("smagorinsky", 0.0, {0.0, 1.0}, "");
  if (v.model == ViscosityModel::Smagorinsky && v.smagorinsky == 0.0)
    t.fail("smagorinsky", "is missing or 0", "give the constant S_c, e.g. 0.1");
  t.finish();
  return v;
}

/// A value's factor over time, from a table `time,factor` beside the scene [s, 1].
TimeTableScene read_time_table(TableReader& t, const std::string& key, const std::string& repeat,
                               const std::string& scene_file) {
  TimeTableScene table;
  const std::string name = t.text_or(key, "");
  table.repeats = repeat == "periodic";
  if (name.empty() && table.repeats)
    t.fail(key, "is missing, and it is to repeat", "give the table, or leave the repeat out");
  if (name.empty()) return table;
  const auto path = std::filesystem::path(scene_file).parent_path() / name;
  const auto fail = [&](const std::string& problem, const std::string& remedy) {
    t.fail(key, "= \"" + name + "\": " + problem, remedy);
  };
  if (const auto problem = protocol::why_unreadable(path, kLargestTable); !problem.empty())
    fail(problem, "put a table `time,factor` beside the scene");
  t.note(key + "_content", fmt::format("checksum {:08x}", protocol::fingerprint(path).crc));
  std::ifstream file(path);
  std::string line;
  std::getline(file, line);
  if (line != "time,factor")
    fail("begins with '" + line.substr(0, 60) + "'", "the first line is time,factor (in s and 1)");
  for (int number = 2; std::getline(file, line); ++number) {
    double time = 0.0, factor = 0.0;
    char rest = 0;
    if (std::sscanf(line.c_str(), "%lf,%lf%c", &time, &factor, &rest) != 2 ||
        !std::isfinite(time + factor))
      fail(fmt::format("line {}: '{}' is not two finite numbers", number, line.substr(0, 60)),
           "give time,factor");
    if (!table.times.empty() && time <= table.times.back())
      fail(fmt::format("line {}: time {:.6g} s does not come after {:.6g} s", number, time,
                       table.times.back()),
           "sort the lines by time, each time once");
    table.times.push_back(time);
    table.factors.push_back(factor);
  }
  if (table.times.size() < 2) fail("holds fewer than two lines", "give at least two times");
  if (table.repeats && table.factors.front() != table.factors.back())
    fail("repeats, and its last factor is not its first",
         "end with the factor that it begins with");
  return table;
}

std::optional<FlowScene> read_flow(TableReader& t, int d) {
  std::vector<std::string> axes{"x", "y", "z"};
  axes.resize(d);
  FlowScene flow;
  const auto rate = t.optional_number("flow_rate", {}, "m³/s");
  flow.axis = t.choice_or("flow_axis", "x", axes)[0] - 'x';
  flow.ramp = t.number_or("flow_ramp", 0.0, Bounds::non_negative(), "s");
  if (!rate) {
    for (const char* key : {"flow_axis", "flow_ramp"})
      if (t.has(key)) t.fail(key, "has no meaning without flow_rate", "leave it out");
    return {};
  }
  flow.rate = *rate;
  return flow;
}

FluidScene read_fluid(TableReader t, int d, const std::string& scene_file) {
  FluidScene fluid;
  fluid.density = t.number("density", Bounds::positive(), "kg/m³");
  if (t.has("viscosity")) fluid.law = read_viscosity(t.table("viscosity"));
  const bool newtonian = fluid.law.model == ViscosityModel::Newtonian ||
                         fluid.law.model == ViscosityModel::Smagorinsky;
  if (!newtonian && t.has("kinematic_viscosity"))
    t.fail("kinematic_viscosity",
           "stands beside a viscosity that depends on the shear rate, model = \"" +
               name_of(fluid.law.model) + "\"",
           "leave it out");
  if (newtonian) fluid.viscosity = t.number("kinematic_viscosity", Bounds::positive(), "m²/s");
  fluid.gravity = t.vector_or_zero("gravity", d, "[m/s²]");
  fluid.body_force = t.vector_or_zero("body_force", d, "[m/s²]");
  fluid.body_force_ramp = t.number_or("body_force_ramp", 0.0, Bounds::non_negative(), "s");
  fluid.body_force_frequency =
      t.number_or("body_force_frequency", 0.0, Bounds::non_negative(), "Hz");
  fluid.body_force_table =
      read_time_table(t, "body_force_table",
                      t.choice_or("body_force_repeat", "once", {"once", "periodic"}), scene_file);
  fluid.flow = read_flow(t, d);
  for (const char* key : {"body_force_frequency", "body_force_table"})
    if (t.has(key) && fluid.body_force.norm() == 0.0)
      t.fail(key, "stands beside a body_force of zero", "give body_force, or leave it out");
  if (fluid.body_force_ramp > 0.0 && fluid.body_force.norm() == 0.0)
    t.fail("body_force_ramp", "stands beside a body_force of zero",
           "give body_force, or leave it out");
  fluid.velocity_scale = t.number("velocity_scale", Bounds::positive(), "m/s");
  t.finish();
  return fluid;
}

NumericsScene read_numerics(TableReader t, int d) {
  NumericsScene n;
  n.cell = t.optional_number("cell", Bounds::positive(), "m");
  n.cells_per_diameter = t.optional_number("cells_per_diameter", {2.0, 10000.0}, "cells");
  if (n.cell.has_value() == n.cells_per_diameter.has_value())
    t.fail("cell", n.cell ? "stands beside cells_per_diameter" : "is missing",
           "give either cell [m] or cells_per_diameter");
  n.time_step = t.optional_number("time_step", Bounds::positive(), "s");
  n.lattice = t.choice_or("lattice", n.lattice,
                          d == 2 ? std::vector<std::string>{"auto", "D2Q9"}
                                 : std::vector<std::string>{"auto", "D3Q19", "D3Q27"});
  n.single = t.choice_or("precision", "double", {"double", "single"}) == "single";
  n.collision = t.choice_or("collision", n.collision,
                            {"auto", "bgk", "trt", "central_moment", "recursive_regularised"});
  n.solid_term =
      t.choice_or("solid_term", n.solid_term,
                  {"auto", "resistance", "layered_resistance", "layered_holdych",
                   "layered_noble_torczynski", "holdych", "noble_torczynski", "superposition"});
  n.scheme =
      t.choice_or("scheme", n.scheme,
                  {"auto", "immersed_moving_boundary", "bounce_back", "interpolated_bounce_back",
                   "implicit_immersed_boundary", "spring_immersed_boundary"});
  n.spring_stiffness = t.number_or("spring_stiffness", n.spring_stiffness, Bounds::positive(), "");
  n.weight = t.choice_or("weight", n.weight, {"auto", "viscous", "balanced", "fraction"});
  n.smagorinsky = t.number_or("smagorinsky", 0.0, {0.0, 1.0}, "");
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

/// `from` and `to` along a side: a number, in three dimensions two.
void read_extent(TableReader& t, const BoxScene& box, int axis, BoundaryScene& b) {
  const int first = axis == 0 ? 1 : 0;
  const auto low = [&](int a) { return box.origin[a]; };
  const auto high = [&](int a) { return box.origin[a] + box.size[a]; };
  if (box.dimension == 2) {
    b.from[0] = t.optional_number("from", {low(first), high(first)}, "m");
    b.to[0] = t.optional_number("to", {b.from[0].value_or(low(first)), high(first)}, "m");
    return;
  }
  const int axes[] = {first, axis == 2 ? 1 : 2};
  for (auto* end : {&b.from, &b.to}) {
    const char* key = end == &b.from ? "from" : "to";
    if (!t.has(key)) continue;
    const Vec3 pair = t.vector(key, 2, "[m] along the side's two axes");
    for (int k = 0; k < 2; ++k) {
      if (pair[k] < low(axes[k]) || pair[k] > high(axes[k]))
        t.fail(key, fmt::format("holds {} m, which is outside the side", pair[k]),
               fmt::format("stay within {} … {} m", low(axes[k]), high(axes[k])));
      (*end)[k] = pair[k];
    }
  }
}

BoundaryScene read_boundary(TableReader t, const BoxScene& box, const std::string& scene_file) {
  using Kind = BoundaryScene::Kind;
  BoundaryScene b;
  std::vector<std::string> sides{"left", "right", "bottom", "top", "back", "front"};
  sides.resize(2 * box.dimension);
  if (!t.has("side"))
    t.fail("side", "is missing", fmt::format("give one of: {}", fmt::join(sides, ", ")));
  const std::string side = t.choice_or("side", "", sides);
  b.side = static_cast<SideName>(std::find(sides.begin(), sides.end(), side) - sides.begin());
  const int axis = axis_of(b.side);
  if (box.sides[axis] == SideKind::Periodic)
    t.fail("side", "= \"" + side + "\" is periodic", "make the box's sides there \"wall\"");
  if (!t.has("kind"))
    t.fail("kind", "is missing", "give velocity, moving_wall, pressure or outflow");
  const std::string kind =
      t.choice_or("kind", "", {"velocity", "moving_wall", "pressure", "outflow"});
  b.kind = kind == "pressure" ? Kind::Pressure : kind == "outflow" ? Kind::Outflow : Kind::Velocity;
  read_extent(t, box, axis, b);
  if (b.kind == Kind::Velocity) {
    b.velocity = t.vector("velocity", box.dimension, "[m/s]");
    b.parabolic = t.choice_or("profile", "uniform", {"uniform", "parabolic"}) == "parabolic";
    b.profile = read_profile(t, b.side, box.dimension, scene_file);
    if (b.parabolic && !b.profile.factors.empty())
      t.fail("profile_table", "stands beside profile = \"parabolic\"", "give one of them");
    if (kind == "moving_wall" && b.velocity[axis] != 0.0)
      t.fail("velocity", "has a component through the wall", "use kind = \"velocity\"");
  } else {
    b.pressure = t.number_or("pressure", 0.0, {}, "Pa");
  }
  if (b.kind != Kind::Outflow) {
    b.frequency = t.number_or("frequency", 0.0, Bounds::non_negative(), "Hz");
    b.table = read_time_table(t, "table", t.choice_or("repeat", "once", {"once", "periodic"}),
                              scene_file);
  }
  b.ramp = t.number_or("ramp", 0.0, Bounds::non_negative(), "s");
  t.finish();
  return b;
}

/// Discs or spheres at rest from a table `x,y,diameter` or `x,y,z,diameter` in m, beside the scene.
void read_grains(TableReader t, const std::string& scene_file, int d,
                 std::vector<ObstacleScene>& obstacles) {
  const std::string name = t.text_or("file", "");
  t.finish();
  if (name.empty()) return;
  const auto path = std::filesystem::path(scene_file).parent_path() / name;
  if (const auto problem = protocol::why_unreadable(path, kLargestTable); !problem.empty())
    t.fail("file", "= \"" + name + "\": " + problem, "put a table of grains beside the scene");
  t.note("content", fmt::format("checksum {:08x}", protocol::fingerprint(path).crc));
  std::ifstream table(path);
  std::string line;
  std::getline(table, line);
  const std::string columns = d == 2 ? "x,y,diameter" : "x,y,z,diameter";
  const auto beginning = [&line] { return line.size() > 60 ? line.substr(0, 60) + "…" : line; };
  if (line != columns)
    t.fail("file", "begins with '" + beginning() + "'", "the first line is " + columns + " (in m)");
  for (int number = 2; std::getline(table, line); ++number) {
    ObstacleScene o;
    o.round = o.grain = true;
    char rest = 0;
    double v[4] = {0.0, 0.0, 0.0, 0.0};
    const int read =
        d == 2 ? std::sscanf(line.c_str(), "%lf,%lf,%lf%c", v, v + 1, v + 3, &rest)
               : std::sscanf(line.c_str(), "%lf,%lf,%lf,%lf%c", v, v + 1, v + 2, v + 3, &rest);
    const bool finite = std::isfinite(v[0] + v[1] + v[2] + v[3]);
    if (read != d + 1 || !finite || !(v[3] > 0.0))
      t.fail("file",
             fmt::format("line {}: '{}' is not {} finite numbers, the last of them positive",
                         number, beginning(), d + 1),
             "give " + columns + " in m");
    o.centre = {v[0], v[1], v[2]};
    o.diameter = v[3];
    obstacles.push_back(o);
  }
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

/// What depends on more than one table: the viscosity at the typical shear rate, and the place of
/// Smagorinsky's constant.
void settle_viscosity(const TableReader& root, Scene& scene) {
  ViscosityScene& law = scene.fluid.law;
  double& constant = scene.numerics.smagorinsky;
  if (law.smagorinsky > 0.0 && constant > 0.0)
    root.fail("fluid.viscosity.smagorinsky", "stands beside numerics.smagorinsky",
              "give one of them");
  constant = std::max(constant, law.smagorinsky);
  if (!law.shear_rate) law.shear_rate = typical_shear_rate(scene);
  scene.fluid.viscosity = ViscosityLaw(scene.fluid, *law.shear_rate).reference();
}

std::string sensor_name(TableReader& t) {
  const std::string name = t.text_or("name", "");
  const bool plain = !name.empty() && name.size() <= 60 &&
                     std::all_of(name.begin(), name.end(), [](unsigned char c) {
                       return std::isalnum(c) || c == '_' || c == '-';
                     });
  if (!plain)
    t.fail("name", name.empty() ? "is missing" : "= \"" + name + "\" cannot name a file",
           "give letters, digits, _ and -: its table is sensor-NAME.csv");
  return name;
}

/// A sensor's line, plane or side.
SensorScene read_sensor(TableReader t, const BoxScene& box) {
  using Kind = SensorScene::Kind;
  SensorScene s;
  const int d = box.dimension;
  s.name = sensor_name(t);
  if (!t.has("kind")) t.fail("kind", "is missing", "give line, plane or side");
  const std::string kind = t.choice_or("kind", "", {"line", "plane", "side"});
  s.kind = kind == "line" ? Kind::Line : kind == "side" ? Kind::Side : Kind::Plane;
  s.every = t.number_or("every", 0.0, Bounds::non_negative(), "s");
  s.from = box.origin;
  s.to = box.origin + box.size;
  if (s.kind == Kind::Line) {
    s.from = t.vector("from", d, "[m]");
    s.to = t.vector("to", d, "[m]");
    s.count = t.optional_integer("count", 2).value_or(20);
  } else if (s.kind == Kind::Plane) {
    std::vector<std::string> axes{"x", "y", "z"};
    axes.resize(d);
    if (!t.has("axis")) t.fail("axis", "is missing", "give the plane's normal, as \"x\"");
    s.axis = t.choice_or("axis", "", axes)[0] - 'x';
    s.at = t.number("at", {box.origin[s.axis], box.origin[s.axis] + box.size[s.axis]}, "m");
    if (t.has("from")) s.from = t.vector("from", d, "[m]");
    if (t.has("to")) s.to = t.vector("to", d, "[m]");
  } else {
    std::vector<std::string> sides{"left", "right", "bottom", "top", "back", "front"};
    sides.resize(2 * d);
    if (!t.has("side"))
      t.fail("side", "is missing", fmt::format("give one of: {}", fmt::join(sides, ", ")));
    const std::string side = t.choice_or("side", "", sides);
    s.side = static_cast<SideName>(std::find(sides.begin(), sides.end(), side) - sides.begin());
  }
  t.finish();
  return s;
}

/// Numbers of particles. What is no whole number is refused.
std::vector<std::int64_t> read_probe_particles(TableReader& t) {
  std::vector<std::int64_t> ids;
  for (const double id : t.numbers_or("probe_particles", {}, {1.0, 9e15}, "")) {
    if (id != std::floor(id))
      t.fail("probe_particles", fmt::format("holds {}, which is no particle's number", id),
             "give ids, as [1, 5]");
    ids.push_back(static_cast<std::int64_t>(id));
  }
  return ids;
}

AverageScene read_average(TableReader t) {
  AverageScene a;
  a.from = t.number_or("from", 0.0, Bounds::non_negative(), "s");
  a.every = t.number_or("every", 0.0, Bounds::non_negative(), "s");
  t.finish();
  return a;
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
  run.finish();
  for (const TableReader& t : root.tables("boundary"))
    scene.boundaries.push_back(read_boundary(t, scene.box, files.front()));
  for (const TableReader& t : root.tables("obstacle"))
    scene.obstacles.push_back(read_obstacle(t, files.front(), scene.box));
  read_grains(root.optional_table("grains"), files.front(), d, scene.obstacles);
  scene.initial = read_initial(root.optional_table("initial"), d);
  settle_viscosity(root, scene);
  TableReader output = root.optional_table("output");
  scene.output.fields_every = output.number_or("fields_every", 0.0, Bounds::non_negative(), "s");
  scene.output.viscosity = output.flag_or("viscosity", false);
  scene.output.probe_every = output.number_or("probe_every", 0.0, Bounds::non_negative(), "s");
  scene.output.points = output.vectors_or_none("points", d, "[m]");
  scene.output.probe_particles = read_probe_particles(output);
  output.finish();
  if (root.has("average")) scene.output.average = read_average(root.table("average"));
  for (const TableReader& t : root.tables("sensor"))
    scene.output.sensors.push_back(read_sensor(t, scene.box));
  root.finish();
  return scene;
}

}  // namespace

Scene read_scene(const std::vector<std::string>& files) {
  toml::table merged = parse(files.front());
  for (std::size_t i = 1; i < files.size(); ++i) overlay(merged, parse(files[i]));
  return read_tables(merged, files, nullptr);
}

void note_keys(const std::string& scene, KeyNotes& keys) {
  read_tables(toml::parse(scene), {"the reader's own example"}, &keys);
}

}  // namespace lbm
