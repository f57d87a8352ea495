// SPDX-License-Identifier: GPL-2.0-or-later
#include "lbm_solver/coupling/particle_gather.h"

#include <map>
#include <unordered_map>
#include <unordered_set>
#include <utility>

#include "protocol/wire/clumps.h"

namespace lbm {
namespace {

void add_to(protocol::Vec3& sum, const protocol::Vec3& part) {
  for (int k = 0; k < 3; ++k) sum[k] += part[k];
}

}  // namespace

GatheredParticles gather_particles(const Decomposition& ranks, std::span<const ParticleLine> mine) {
  std::map<std::int64_t, std::pair<const protocol::Particle*, protocol::Load>> by_id;
  const std::vector<ParticleLine> lines = collect_lines(ranks, mine);
  for (const ParticleLine& line : lines) {
    auto& [particle, load] = by_id[line.load.id];
    load.id = line.load.id;
    add_to(load.force, line.load.force);
    add_to(load.torque, line.load.torque);
    if (line.home != 0) particle = &line.particle;
  }
  GatheredParticles all;
  for (const auto& [id, both] : by_id) {
    if (!both.first) continue;
    all.particles.push_back(*both.first);
    all.loads.push_back(both.second);
  }
  return all;
}

void hide_hulls(std::vector<protocol::Particle>& particles) {
  std::unordered_set<std::int64_t> clumps;
  for (const auto& p : particles)
    if (protocol::is_part(p.shape)) clumps.insert(p.shape.carrier);
  if (clumps.empty()) return;
  for (auto& p : particles)
    if (clumps.contains(p.state.id)) p.shape.radius = 0.0;
}

std::vector<LightLine> share_light(const Decomposition& ranks, std::span<const LightLine> mine) {
  std::unordered_map<std::int64_t, std::size_t> places;
  std::vector<LightLine> whole(mine.size());
  for (std::size_t i = 0; i < mine.size(); ++i) {
    places.emplace(mine[i].id, i);
    whole[i].id = mine[i].id;
    whole[i].mean_change = mine[i].mean_change;
  }
  for (const LightLine& line : share_lines(ranks, mine)) {
    const auto found = places.find(line.id);
    if (found == places.end()) continue;
    LightLine& sum = whole[found->second];
    add_to(sum.force, line.force);
    add_to(sum.torque, line.torque);
    if (line.home != 0) sum.mean_change = line.mean_change;
  }
  return whole;
}

}  // namespace lbm
