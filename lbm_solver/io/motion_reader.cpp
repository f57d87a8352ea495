// SPDX-License-Identifier: GPL-2.0-or-later
#include "lbm_solver/io/motion_reader.h"

#include <fmt/core.h>

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "lbm_solver/io/text_table.h"
#include "protocol/program/checksum.h"
#include "protocol/program/input_file.h"

namespace lbm {
namespace {

using MotionKind = MotionScene::Kind;

constexpr std::uintmax_t kLargestMotion = 100'000'000;  // bytes

/// Lines `time,x,y[,z][,angle]` [s, m, rad].
void read_table(TableReader& t, const std::string& scene_file, int dimension, MotionScene& m) {
  const std::string name = t.text_or("motion_table", "");
  const auto fail = [&](const std::string& problem, const std::string& remedy) {
    t.fail("motion_table", "= \"" + name + "\": " + problem, remedy);
  };
  const std::string plain = dimension == 2 ? "time,x,y" : "time,x,y,z", turning = plain + ",angle";
  const std::string remedy = "the first line is " + plain + " or " + turning + " (in s, m and rad)";
  if (name.empty()) t.fail("motion_table", "is missing", "name a table of " + turning);
  const auto path = std::filesystem::path(scene_file).parent_path() / name;
  if (const auto problem = protocol::why_unreadable(path, kLargestMotion); !problem.empty())
    fail(problem, "put a table " + turning + " beside the scene");
  t.note("motion_table_content", fmt::format("checksum {:08x}", protocol::fingerprint(path).crc));
  TextTable file(path);
  file.next();
  if (file.line() != plain && file.line() != turning)
    fail("begins with '" + file.shown() + "'", remedy);
  const bool turns = file.line() == turning;
  const auto d = static_cast<std::size_t>(dimension);
  while (file.next()) {
    const std::vector<double> v = file.numbers(1 + d + (turns ? 1 : 0));
    if (v.empty())
      fail(fmt::format("line {}: '{}' is not {} finite numbers", file.number(), file.shown(),
                       1 + d + (turns ? 1 : 0)),
           remedy);
    if (!m.times.empty() && v[0] <= m.times.back())
      fail(fmt::format("line {}: time {:.6g} s does not come after {:.6g} s", file.number(), v[0],
                       m.times.back()),
           "sort the lines by time, each time once");
    m.times.push_back(v[0]);
    m.shifts.emplace_back(v[1], v[2], dimension == 3 ? v[3] : 0.0);
    m.angles.push_back(turns ? v.back() : 0.0);
  }
  if (m.times.size() < 2) fail("holds fewer than two lines", "give at least two times");
}

void read_oscillation(TableReader& t, int dimension, MotionScene& m) {
  m.amplitude = t.vector_or_zero("amplitude", dimension, "[m]");
  m.angular_amplitude = t.number_or("angular_amplitude", 0.0, {}, "rad");
  m.frequency = t.number("frequency", Bounds::positive(), "Hz");
  if (m.amplitude.isZero(0.0) && m.angular_amplitude == 0.0)
    t.fail("amplitude", "is missing or 0", "give amplitude [m] or angular_amplitude [rad]");
}

/// Where it turns, and about what.
void read_axis(TableReader& t, int dimension, ReadMotion& read) {
  MotionScene& m = read.motion;
  const bool turns = m.angular_velocity != 0.0 || m.angular_amplitude != 0.0 ||
                     (m.kind == MotionKind::Table && dimension == 3 && t.has("axis"));
  read.has_pivot = t.has("about");
  if (read.has_pivot) m.about = t.vector("about", dimension, "[m], through which the axis goes");
  for (const double angle : m.angles)
    if (angle != 0.0 && dimension == 3 && !t.has("axis"))
      t.fail("axis", "is missing, and the table turns the obstacle", "give its direction");
  if (dimension == 2 || !turns) return;
  m.axis = t.vector("axis", 3, "direction of the axis of rotation");
  if (m.axis.norm() == 0.0) t.fail("axis", "is zero", "give its direction, e.g. [0, 0, 1]");
  m.axis.normalize();
}

/// Keys of a motion without its kind.
void check_forgotten(TableReader& t) {
  constexpr std::pair<const char*, const char*> kinds[] = {
      {"velocity", "linear"},       {"angular_velocity", "rotation"},
      {"amplitude", "oscillation"}, {"angular_amplitude", "oscillation"},
      {"frequency", "oscillation"}, {"motion_table", "table"},
      {"axis", "rotation"},         {"about", "rotation"},
      {"surface_only", "rotation"}};
  for (const auto& [key, kind] : kinds)
    if (t.has(key))
      t.fail("motion", fmt::format("is missing beside {}: the obstacle would not move", key),
             fmt::format("give motion = \"{}\"{}, or leave {} out", kind,
                         std::string(key) == "surface_only" ? ", or another" : "", key));
}

}  // namespace

std::optional<ReadMotion> read_motion(TableReader& t, const std::string& scene_file, int d) {
  if (!t.has("motion")) {
    check_forgotten(t);
    return std::nullopt;
  }
  ReadMotion read;
  MotionScene& m = read.motion;
  const std::string kind =
      t.choice_or("motion", "", {"linear", "rotation", "oscillation", "table"});
  m.kind = kind == "linear"     ? MotionKind::Linear
           : kind == "rotation" ? MotionKind::Rotation
           : kind == "table"    ? MotionKind::Table
                                : MotionKind::Oscillation;
  if (m.kind == MotionKind::Linear) {
    m.velocity = t.vector("velocity", d, "[m/s]");
    if (m.velocity.isZero(0.0)) t.fail("velocity", "is zero", "leave motion out: it is at rest");
  }
  if (m.kind == MotionKind::Rotation) {
    m.angular_velocity = t.number("angular_velocity", {}, "rad/s");
    if (m.angular_velocity == 0.0)
      t.fail("angular_velocity", "is zero", "leave motion out: it is at rest");
  }
  if (m.kind == MotionKind::Oscillation) read_oscillation(t, d, m);
  if (m.kind == MotionKind::Table) read_table(t, scene_file, d, m);
  read_axis(t, d, read);
  m.surface_only = t.flag_or("surface_only", false);
  return read;
}

}  // namespace lbm
