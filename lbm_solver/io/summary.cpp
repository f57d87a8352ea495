// SPDX-License-Identifier: GPL-2.0-or-later
#include "lbm_solver/io/summary.h"

#include <fmt/core.h>

#include <cstdio>
#include <fstream>
#include <nlohmann/json.hpp>

#include "lbm_solver/base/errors.h"

namespace lbm {

namespace {

using Json = nlohmann::ordered_json;

const std::map<std::string, std::string> kUnits{
    {"physical_seconds", "s"},
    {"wall_seconds", "s"},
    {"cpu_seconds", "s"},
    {"waiting", "s"},
    {"mlups", "1e6 cells/s"},
    {"megabytes", "MB"},
    {"peak_megabytes", "MB"},
    {"writing", "s"},
    {"busiest_rank", "1"},
    {"block_moves", "1"},
    {"cell", "m"},
    {"time_step", "s"},
    {"interval", "s"},
    {"density", "kg/m³"},
    {"particle_density", "kg/m³"},
    {"kinematic_viscosity", "m²/s"},
    {"mean_viscosity", "m²/s"},
    {"shear_rate_max", "1/s"},
    {"share_at_rest_bound", "1"},
    {"share_at_shear_bound", "1"},
    {"flow", "m³/s"},
    {"wanted_flow", "m³/s"},
    {"held_pressure", "Pa"},
    {"pressure_gradient", "Pa/m"},
    {"body_force_x", "m/s²"},
    {"body_force_y", "m/s²"},
    {"body_force_z", "m/s²"},
    {"pressure_jump_x", "Pa"},
    {"pressure_jump_y", "Pa"},
    {"pressure_jump_z", "Pa"},
    {"gravity_x", "m/s²"},
    {"gravity_y", "m/s²"},
    {"gravity_z", "m/s²"},
    {"depth", "m"},
    {"box_x", "m"},
    {"box_y", "m"},
    {"box_z", "m"},
    {"diameter", "m"},
    {"velocity_scale", "m/s"},
    // numbers and ratios
    {"cells", "1"},
    {"steps", "1"},
    {"substeps", "1"},
    {"time_share", "1"},
    {"ma_max", "1"},
    {"ma_paper", "1"},
    {"re", "1"},
    {"re_h", "1"},
    {"mass_drift", "1"},
    {"tau", "1"},
    {"cells_per_diameter", "1"},
    {"grains", "1"},
    {"bonds", "1"},
};

void add_solid(const protocol::SolidReport& solid, Json& json) {
  json["grains"] = {{"left", solid.grains_left}};
  if (!solid.bonds) return;
  const auto& [intact, tension, shear, left, lost] = *solid.bonds;
  json["bonds"] = {
      {"intact", intact}, {"tension", tension}, {"shear", shear}, {"left", left}, {"lost", lost}};
}

/// Of each number, and of each group of numbers of one unit.
Json units(const Json& json) {
  Json all;
  for (const auto& [name, value] : json.items()) {
    if (name == "parameters")
      for (const auto& [parameter, number] : value.items())
        all[name][parameter] = unit_of(parameter);
    else if (value.is_number() || (value.is_object() && name != "versions"))
      all[name] = unit_of(name);
  }
  return all;
}

}  // namespace

std::string describe(const protocol::SolidReport& report) {
  std::string text;
  if (report.grains_left > 0) text = fmt::format("{} grains left", report.grains_left);
  if (!report.bonds) return text;
  const auto& [intact, tension, shear, left, lost] = *report.bonds;
  text += fmt::format("{}bonds {} (broken by tension {}, by shear {}", text.empty() ? "" : ", ",
                      intact, tension, shear);
  if (left > 0) text += fmt::format("; left with grains {}", left);
  if (lost > 0) text += fmt::format("; lost {}", lost);
  return text + ")";
}

std::string unit_of(const std::string& name) {
  const auto unit = kUnits.find(name);
  if (unit == kUnits.end()) throw std::out_of_range("no unit is known of '" + name + "'");
  return unit->second;
}

void write_summary(const std::string& folder, const Summary& s) {
  Json json{
      {"scene", s.scene},
      {"set", s.set},
      {"variant", s.variant},
      {"versions", s.versions},
      {"ending", s.ending},
      {"cells", s.cells},
      {"steps", s.steps},
      {"substeps", s.substeps},
      {"physical_seconds", s.physical_seconds},
      {"wall_seconds", s.wall_seconds},
      {"cpu_seconds", s.cpu_seconds},
      {"mlups", s.mlups},
      {"time_share", s.time_share},
      {"megabytes", s.megabytes},
      {"peak_megabytes", s.peak_megabytes},
      {"writing", s.writing},
      {"busiest_rank", s.busiest_rank},
      {"block_moves", s.block_moves},
      {"waiting", s.waiting},
      {"ma_max", s.ma_max},
      {"ma_paper", s.ma_paper},
      {"re", s.re},
      {"re_h", s.re_h},
      {"mass_drift", s.mass_drift},
      {"parameters", s.parameters},
  };
  if (s.solid) add_solid(*s.solid, json);
  json["units"] = units(json);
  json["results"] = Json::array();
  const std::string path = folder + "/summary.json", part = path + ".part";
  {
    std::ofstream out(part);
    out << json.dump(2) << '\n';
    if (!out.flush())
      throw InputError(path, "cannot be written",
                       "is the disk full, or has its folder been moved?");
  }
  if (std::rename(part.c_str(), path.c_str()) != 0)
    throw InputError(path, "cannot be replaced", "is the folder writable?");
}

}  // namespace lbm
