// SPDX-License-Identifier: GPL-2.0-or-later
#include "lbm_solver/io/output_reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>

#include "lbm_solver/io/hdf5_files.h"

namespace lbm {
namespace {

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
    const std::vector<std::string> sides(kSideNames.begin(), kSideNames.begin() + 2 * d);
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

}  // namespace

OutputScene read_output(TableReader& root, const BoxScene& box) {
  OutputScene output;
  TableReader t = root.optional_table("output");
  output.fields_every = t.number_or("fields_every", 0.0, Bounds::non_negative(), "s");
  expect_hdf5(t, "fields_every", output.fields_every > 0.0);
  output.viscosity = t.flag_or("viscosity", false);
  output.probe_every = t.number_or("probe_every", 0.0, Bounds::non_negative(), "s");
  output.points = t.vectors_or_none("points", box.dimension, "[m]");
  output.probe_particles = read_probe_particles(t);
  t.finish();
  expect_hdf5(root, "average", root.has("average"));
  if (root.has("average")) output.average = read_average(root.table("average"));
  for (const TableReader& sensor : root.tables("sensor"))
    output.sensors.push_back(read_sensor(sensor, box));
  return output;
}

}  // namespace lbm
