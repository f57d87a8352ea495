// SPDX-License-Identifier: GPL-2.0-or-later
#include "lbm_solver/io/boundary_reader.h"

#include <fmt/format.h>

#include <algorithm>

#include "lbm_solver/io/profile_reader.h"
#include "lbm_solver/io/time_table_reader.h"

namespace lbm {
namespace {

using BoundaryKind = BoundaryScene::Kind;

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

SideName read_side(TableReader& t, const BoxScene& box) {
  const std::vector<std::string> sides(kSideNames.begin(), kSideNames.begin() + 2 * box.dimension);
  if (!t.has("side"))
    t.fail("side", "is missing", fmt::format("give one of: {}", fmt::join(sides, ", ")));
  const std::string name = t.choice_or("side", "", sides);
  const auto side = static_cast<SideName>(std::ranges::find(sides, name) - sides.begin());
  if (box.sides[axis_of(side)] == SideKind::Periodic)
    t.fail("side", "= \"" + name + "\" is periodic", "make the box's sides there \"wall\"");
  return side;
}

void read_velocity(TableReader& t, const BoxScene& box, const std::string& scene_file,
                   bool moving_wall, BoundaryScene& b) {
  b.velocity = t.vector("velocity", box.dimension, "[m/s]");
  b.parabolic = t.choice_or("profile", "uniform", {"uniform", "parabolic"}) == "parabolic";
  b.profile = read_profile(t, b.side, box.dimension, scene_file);
  if (b.parabolic && !b.profile.factors.empty())
    t.fail("profile_table", "stands beside profile = \"parabolic\"", "give one of them");
  if (moving_wall && b.velocity[axis_of(b.side)] != 0.0)
    t.fail("velocity", "has a component through the wall", "use kind = \"velocity\"");
}

void read_pressure(TableReader& t, BoundaryScene& b) {
  b.pressure = t.number_or("pressure", 0.0, {}, "Pa");
  if (b.kind == BoundaryKind::Pressure) b.flow_rate = t.optional_number("flow_rate", {}, "m³/s");
  if (b.kind == BoundaryKind::Outflow && t.has("flow_rate"))
    t.fail("flow_rate", "has no meaning for an outflow", "take kind = \"pressure\"");
}

/// How the value changes in time; that of an outflow stays.
void read_in_time(TableReader& t, const std::string& scene_file, BoundaryScene& b) {
  if (b.kind != BoundaryKind::Outflow) {
    b.frequency = t.number_or("frequency", 0.0, Bounds::non_negative(), "Hz");
    b.table = read_time_table(t, "table", t.choice_or("repeat", "once", {"once", "periodic"}),
                              scene_file);
    b.ramp = t.number_or("ramp", 0.0, Bounds::non_negative(), "s");
    return;
  }
  for (const char* key : {"ramp", "frequency", "table", "repeat"})
    if (t.has(key))
      t.fail(key, "has no meaning for an outflow, whose pressure is steady",
             "leave it out, or take kind = \"pressure\"");
}

}  // namespace

BoundaryScene read_boundary(TableReader t, const BoxScene& box, const std::string& scene_file) {
  BoundaryScene b;
  b.side = read_side(t, box);
  const int axis = axis_of(b.side);
  if (!t.has("kind"))
    t.fail("kind", "is missing", "give velocity, moving_wall, pressure or outflow");
  const std::string kind =
      t.choice_or("kind", "", {"velocity", "moving_wall", "pressure", "outflow"});
  b.kind = kind == "pressure"  ? BoundaryKind::Pressure
           : kind == "outflow" ? BoundaryKind::Outflow
                               : BoundaryKind::Velocity;
  read_extent(t, box, axis, b);
  if (b.kind == BoundaryKind::Velocity)
    read_velocity(t, box, scene_file, kind == "moving_wall", b);
  else
    read_pressure(t, b);
  read_in_time(t, scene_file, b);
  t.finish();
  return b;
}

}  // namespace lbm
