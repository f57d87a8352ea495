// SPDX-License-Identifier: GPL-2.0-or-later
#include "lbm_solver/coupling/particle_state.h"

#include <algorithm>
#include <array>
#include <string>
#include <unordered_map>

#include "lbm_solver/coupling/particle_gather.h"

namespace lbm {
namespace {

/// A vector that a checkpoint keeps of a carrier, under a name.
struct Kept {
  const char* name;
  protocol::Vec3& (*of)(Past&);
};
constexpr std::array<Kept, 6> kKept{
    {{"velocities", [](Past& p) -> protocol::Vec3& { return p.motion.v; }},
     {"angular_velocities", [](Past& p) -> protocol::Vec3& { return p.motion.omega; }},
     {"forces", [](Past& p) -> protocol::Vec3& { return p.force; }},
     {"torques", [](Past& p) -> protocol::Vec3& { return p.torque; }},
     {"mean_velocity_changes", [](Past& p) -> protocol::Vec3& { return p.mean_change.v; }},
     {"mean_angular_velocity_changes",
      [](Past& p) -> protocol::Vec3& { return p.mean_change.omega; }}}};

}  // namespace

Record save_past(const Decomposition& ranks, std::span<const Past> mine,
                 std::span<const protocol::Load> loads) {
  std::vector<Past> all = collect_lines(ranks, mine);
  std::unordered_map<std::int64_t, const protocol::Load*> load_of;
  for (const protocol::Load& load : loads) load_of.emplace(load.id, &load);
  std::vector<std::int64_t> ids, epochs;
  for (Past& past : all) {
    ids.push_back(past.id);
    epochs.push_back(past.epoch);
    const auto load = load_of.find(past.id);
    if (load == load_of.end()) continue;
    past.force = load->second->force;
    past.torque = load->second->torque;
  }
  Record record;
  for (const Kept& kept : kKept) {
    std::vector<double> vectors;
    for (Past& past : all) {
      const protocol::Vec3& v = kept.of(past);
      vectors.insert(vectors.end(), v.begin(), v.end());
    }
    record.set(kept.name, std::move(vectors));
  }
  record.set("ids", std::move(ids));
  record.set("epochs", std::move(epochs));
  return record;
}

std::vector<Past> load_past(const Record& record) {
  const auto& ids = record.get<std::vector<std::int64_t>>("ids");
  const auto& epochs = record.list<std::int64_t>("epochs", ids.size());
  std::vector<Past> all(ids.size());
  for (std::size_t i = 0; i < all.size(); ++i) {
    all[i].id = ids[i];
    all[i].epoch = epochs[i];
  }
  for (const Kept& kept : kKept) {
    const auto& vectors = record.list<double>(kept.name, 3 * ids.size());
    for (std::size_t i = 0; i < all.size(); ++i)
      std::copy_n(&vectors[3 * i], 3, kept.of(all[i]).begin());
  }
  return all;
}

}  // namespace lbm
