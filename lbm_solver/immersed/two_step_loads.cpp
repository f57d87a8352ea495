// SPDX-License-Identifier: GPL-2.0-or-later
#include "lbm_solver/immersed/two_step_loads.h"

#include <bit>

#include "lbm_solver/field/decomposition.h"

namespace lbm {
namespace {

constexpr int kLine = 7;  // id, force, torque

}  // namespace

void TwoStepLoads::remember(std::span<const Body> bodies, std::span<const BodyLoad> raw) {
  before_.clear();
  for (std::size_t i = 0; i < bodies.size(); ++i) before_.emplace(bodies[i].id, raw[i]);
  of_all_ranks_ = false;
}

std::vector<BodyLoad> TwoStepLoads::mean(std::span<const Body> bodies,
                                         std::span<const BodyLoad> raw, const Domain& domain,
                                         const Block& cells) const {
  std::vector<BodyLoad> loads(raw.begin(), raw.end());
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    const auto found = before_.find(bodies[i].id);
    if (found == before_.end()) continue;
    const bool elsewhere = of_all_ranks_ && !holds(domain, cells, bodies[i].centre);
    const BodyLoad before = elsewhere ? BodyLoad{} : found->second;
    loads[i].force += lag_ * (before.force - raw[i].force);
    loads[i].torque += lag_ * (before.torque - raw[i].torque);
  }
  return loads;
}

Record TwoStepLoads::save(const Decomposition& ranks) const {
  std::vector<double> lines;
  for (const auto& [id, load] : before_) {
    lines.push_back(std::bit_cast<double>(id));
    for (const Vec3* v : {&load.force, &load.torque})
      lines.insert(lines.end(), v->begin(), v->end());
  }
  lines = ranks.collect(lines);
  std::vector<std::int64_t> ids;
  std::vector<double> loads;
  for (auto l = lines.begin(); l != lines.end(); l += kLine) {
    ids.push_back(std::bit_cast<std::int64_t>(*l));
    loads.insert(loads.end(), l + 1, l + kLine);
  }
  Record record;
  record.set("ids", std::move(ids));
  record.set("forces_and_torques", std::move(loads));
  return record;
}

void TwoStepLoads::load(const Record& record) {
  const auto& ids = record.get<std::vector<std::int64_t>>("ids");
  const auto& loads = record.list<double>("forces_and_torques", 6 * ids.size());
  before_.clear();
  for (std::size_t i = 0; i < ids.size(); ++i) {
    const double* l = &loads[6 * i];
    BodyLoad& load = before_[ids[i]];  // ranks hold parts of it
    load.force += Vec3(l[0], l[1], l[2]);
    load.torque += Vec3(l[3], l[4], l[5]);
  }
  of_all_ranks_ = true;
}

}  // namespace lbm
