// SPDX-License-Identifier: GPL-2.0-or-later
#include "lbm_solver/immersed/two_step_loads.h"

#include <stdexcept>

#include "lbm_solver/field/decomposition.h"

namespace lbm {
namespace {

constexpr std::size_t kLine = 7;

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

std::vector<double> TwoStepLoads::lines() const {
  std::vector<double> lines;
  for (const auto& [id, load] : before_) {
    lines.push_back(static_cast<double>(id));
    for (const Vec3* v : {&load.force, &load.torque})
      lines.insert(lines.end(), v->begin(), v->end());
  }
  return lines;
}

void TwoStepLoads::restore(std::span<const double> lines) {
  if (lines.size() % kLine != 0) throw std::invalid_argument("'loads' is of another size");
  before_.clear();
  for (const double* l = lines.data(); l < lines.data() + lines.size(); l += kLine) {
    BodyLoad& load = before_[static_cast<std::int64_t>(l[0])];  // ranks hold parts of it
    load.force += Vec3(l[1], l[2], l[3]);
    load.torque += Vec3(l[4], l[5], l[6]);
  }
  of_all_ranks_ = true;
}

}  // namespace lbm
