// SPDX-License-Identifier: GPL-2.0-or-later
#include "lbm_solver/coupling/restart.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>

#include "lbm_solver/base/errors.h"
#include "lbm_solver/io/checkpoint.h"
#include "protocol/program/checksum.h"
#include "protocol/program/solid_parts.h"

namespace lbm {
namespace {

namespace fs = std::filesystem;

using Settings = std::map<std::string, std::string>;

constexpr const char* kBeginAnew = "start again without --restart";

/// Of output and of the run's end: nothing that the next step depends on.
constexpr std::array kFree{"title",
                           "run.end_time",
                           "run.steady_below",
                           "output",
                           "numerics.blocks",
                           "numerics.waiting_bound",
                           "run.checkpoint_every",
                           "coupling.timeout",
                           "coupling.connect_timeout"};
/// Of what drives the run: the state fits whatever they are.
constexpr std::array kAcceptable{"fluid.gravity",
                                 "fluid.body_force",
                                 "box.pressure_jump",
                                 "particles.variables",
                                 "particles.contact_stiffness",
                                 "coupling.lubrication_range",
                                 "coupling.virtual_mass",
                                 "coupling.inner_inertia",
                                 "coupling.buoyancy"};
constexpr std::array kOfABoundary{"velocity",  "pressure", "profile", "ramp",
                                  "frequency", "table",    "repeat"};

bool is_or_is_in(const std::string& key, const std::string& table) {
  return key == table || key.starts_with(table + ".");
}

/// What `auto` and the rules of the plan have made of a scene; the populations are of this grid.
Settings planned(const Plan& plan) {
  const auto& d = plan.domain;
  return {{"plan.cells", fmt::format("{} x {} x {}", d.nx, d.ny, d.nz)},
          {"plan.populations", name_of(plan.kernel.lattice)},
          {"plan.precision", name_of(plan.kernel.precision)},
          {"plan.collision", name_of(plan.kernel.collision)},
          {"plan.solid_term", name_of(plan.kernel.solid_term)},
          {"plan.scheme", name_of(plan.scheme)},
          {"plan.tau", fmt::format("{}", plan.kernel.parameters.tau)},
          {"plan.time_step", fmt::format("{}", plan.wished_step)},
          {"plan.fluid_steps", fmt::format("{}", plan.fluid_steps)},
          {"plan.substeps", fmt::format("{}", plan.substeps)}};
}

Settings settings_of(const Scene& scene, const Plan& plan) {
  Settings all = planned(plan);
  for (const auto& [key, value] : scene.settings)
    if (!may_change(key)) all[key] = value;
  return all;
}

struct Difference {
  std::string key, then, now;
};

std::vector<Difference> differences(const Record& then, const Settings& now) {
  Settings before;
  for (const auto& [key, value] : then.values())
    if (const auto* text = std::get_if<std::string>(&value)) before[key] = *text;
  const auto value = [](const Settings& settings, const std::string& key) {
    const auto found = settings.find(key);
    return found == settings.end() ? std::string("not given") : found->second;
  };
  Settings all = now;
  all.insert(before.begin(), before.end());
  std::vector<Difference> found;
  for (const auto& [key, any] : all)
    if (value(before, key) != value(now, key))
      found.push_back({key, value(before, key), value(now, key)});
  return found;
}

/// The solid's part, as the fluid's says that it was.
void check_solid_part(const Restart& restart, const std::string& from) {
  if (!fs::is_regular_file(restart.solid_part))
    throw InputError(
        restart.solid_part, "is missing: the solid's part of the checkpoint",
        from == "fault" ? "use --restart alone for the last whole checkpoint" : kBeginAnew);
  if (from == "fault") return;  // each program kept its own, and does not know the other's
  const Record& kept = restart.record.part("solid_part");
  const protocol::Fingerprint found = protocol::fingerprint(restart.solid_part);
  if (kept.integer("bytes") == static_cast<std::int64_t>(found.bytes) &&
      kept.integer("crc32") == static_cast<std::int64_t>(found.crc))
    return;
  throw InputError(restart.solid_part,
                   "is damaged, or another file than the solid wrote at that interval", kBeginAnew);
}

enum class Damage { Look, KnownToBeNone };

Restart read_pair(const Scene& scene, const std::string& folder, const std::string& path,
                  const RestartOptions& options, Damage damage = Damage::Look) {
  Restart restart;
  restart.path = path;
  restart.record = damage == Damage::Look ? read_checkpoint(path) : read_record(path);
  try {
    restart.interval = restart.record.integer("interval");
    restart.step = restart.record.real("time_step");
    if (restart.interval < 0 || !std::isfinite(restart.step) || !(restart.step > 0.0))
      throw std::invalid_argument("'interval' or 'time_step' is no such number");
    if (!scene.coupling) return restart;
    restart.solid_part = protocol::SolidParts(folder + "/" + options.from).name(restart.interval);
    if (damage == Damage::Look) check_solid_part(restart, options.from);
  } catch (const std::invalid_argument& error) {
    throw InputError(path, fmt::format("is no checkpoint of this scene: {}", error.what()),
                     kBeginAnew);
  }
  return restart;
}

}  // namespace

std::string fluid_part(const std::string& folder, const std::string& name) {
  return fmt::format("{}/{}.h5", folder, name);
}
std::string fluid_part_before(const std::string& folder, const std::string& name) {
  return fmt::format("{}/{}.before.h5", folder, name);
}

bool may_change(const std::string& key) {
  return std::any_of(kFree.begin(), kFree.end(),
                     [&](const char* free) { return is_or_is_in(key, free); });
}

bool may_be_accepted(const std::string& key) {
  if (key.starts_with("boundary."))
    return std::any_of(kOfABoundary.begin(), kOfABoundary.end(),
                       [&](const char* name) { return key.ends_with(std::string(".") + name); });
  return std::any_of(kAcceptable.begin(), kAcceptable.end(),
                     [&](const char* acceptable) { return is_or_is_in(key, acceptable); });
}

std::optional<Restart> find_restart(const Scene& scene, const std::string& folder,
                                    const RestartOptions& options) {
  if (options.from.empty()) return std::nullopt;
  const std::string last = fluid_part(folder, options.from);
  const std::string before = fluid_part_before(folder, options.from);
  if (options.from == "fault" && !scene.coupling)
    throw InputError(last, "is kept by coupled runs only", "use --restart for the last checkpoint");
  try {
    return read_pair(scene, folder, last, options);
  } catch (const InputError& error) {
    if (!fs::exists(before)) throw;
    const std::string problem = error.what();
    try {
      Restart restart = read_pair(scene, folder, before, options);
      restart.earlier = true;
      restart.remark = problem.substr(0, problem.rfind("; "));  // its cure has been taken
      return restart;
    } catch (const InputError& second) {
      throw InputError(
          fmt::format("{}\nlbm | error | and the pair before it: {}", problem, second.what()),
          "no checkpoint is left to go on from");
    }
  }
}

Restart take_restart(const Scene& scene, const std::string& folder, const RestartOptions& options,
                     bool earlier) {
  const std::string path =
      earlier ? fluid_part_before(folder, options.from) : fluid_part(folder, options.from);
  Restart restart = read_pair(scene, folder, path, options, Damage::KnownToBeNone);
  restart.earlier = earlier;
  return restart;
}

void check_same_scene(const Restart& restart, const Scene& scene, const Plan& plan,
                      const RestartOptions& options) {
  for (const std::string& key : options.accept) {
    const auto in_key = [&](const auto& setting) {
      return is_or_is_in(setting.first, key) && may_be_accepted(setting.first);
    };
    if (may_be_accepted(key) || std::any_of(scene.settings.begin(), scene.settings.end(), in_key))
      continue;
    throw InputError("--accept " + key, "is nothing that a restart may change",
                     fmt::format("it may change {}, and of a boundary (boundary, boundary.1, …) {}",
                                 fmt::join(kAcceptable, ", "), fmt::join(kOfABoundary, ", ")));
  }
  std::string list;
  bool acceptable = true;
  for (const Difference& d : differences(restart.record.part("scene"), settings_of(scene, plan))) {
    const bool could = may_be_accepted(d.key);
    const bool accepted = std::any_of(options.accept.begin(), options.accept.end(),
                                      [&](const auto& key) { return is_or_is_in(d.key, key); });
    if (could && accepted) continue;
    list += fmt::format("\n  {}: {} then, {} now", d.key, d.then, d.now);
    acceptable = acceptable && could;
  }
  if (list.empty()) return;
  throw InputError(
      fmt::format("{} was written by a run of another scene:{}\n", restart.path, list),
      acceptable ? "restart with the scene and overlays of that run, or give --accept KEY for each "
                   "change that is meant"
                 : "restart with the scene and overlays of that run");
}

Record checkpoint_record(const Scene& scene, const Plan& plan, std::int64_t interval,
                         const std::string& solid_part) {
  Record record, settings;
  for (const auto& [key, value] : settings_of(scene, plan)) settings.set(key, value);
  record.set("scene", std::move(settings));
  record.set("program", std::string("lbm ") + BPLBM_VERSION);
  record.set("interval", interval);
  record.set("time_step", plan.units.dt);
  if (solid_part.empty()) return record;
  if (!fs::is_regular_file(solid_part))
    throw InputError(solid_part, "is not there: the solid says that it has written it",
                     "give an --out folder that both programs see");
  const protocol::Fingerprint print = protocol::fingerprint(solid_part);
  Record solid;
  solid.set("file", fs::path(solid_part).filename().string());
  solid.set("bytes", static_cast<std::int64_t>(print.bytes));
  solid.set("crc32", static_cast<std::int64_t>(print.crc));
  record.set("solid_part", std::move(solid));
  return record;
}

}  // namespace lbm
