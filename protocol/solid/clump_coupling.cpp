// SPDX-License-Identifier: MIT
#include "protocol/solid/clump_coupling.h"

#include <algorithm>
#include <cmath>
#include <type_traits>

#include "protocol/wire/ball_union.h"

namespace protocol {
namespace {

/// Records of all ranks, in rank order. Collective.
template <class Record>
std::vector<Record> share(MPI_Comm comm, std::span<const Record> mine) {
  static_assert(std::is_trivially_copyable_v<Record>);
  int ranks = 1;
  MPI_Comm_size(comm, &ranks);
  if (ranks == 1) return {mine.begin(), mine.end()};
  const int bytes = static_cast<int>(mine.size_bytes());
  std::vector<int> sizes(ranks), starts(ranks, 0);
  MPI_Allgather(&bytes, 1, MPI_INT, sizes.data(), 1, MPI_INT, comm);
  for (int r = 1; r < ranks; ++r) starts[r] = starts[r - 1] + sizes[r - 1];
  std::vector<Record> all((starts.back() + sizes.back()) / sizeof(Record));
  MPI_Allgatherv(mine.data(), bytes, MPI_BYTE, all.data(), sizes.data(), starts.data(), MPI_BYTE,
                 comm);
  return all;
}

/// The shortest over periodic images.
Vec3 arm(const Hello& box, const Vec3& from, const Vec3& to) {
  Vec3 arm{};
  for (unsigned k = 0; k < box.dimension; ++k) {
    const double length = box.box_hi[k] - box.box_lo[k];
    arm[k] = to[k] - from[k];
    if (box.periodic[k]) arm[k] -= length * std::round(arm[k] / length);
  }
  return arm;
}

bool by_carrier(const EngineSphere& a, const EngineSphere& b) {
  return a.carrier != b.carrier ? a.carrier < b.carrier : a.id < b.id;
}

}  // namespace

ClumpCoupling::Known ClumpCoupling::measure(const Hello& box, const EngineClump& clump,
                                            std::span<const EngineSphere> spheres) {
  std::vector<Ball> balls;
  for (const EngineSphere& s : spheres) balls.push_back({s.id, arm(box, clump.x, s.x), s.radius});
  const bool told = clump.volume > 0.0;
  return {bounding_radius(balls),
          told ? clump.volume : moments_of_union(balls, box.dimension, box.depth).volume};
}

void ClumpCoupling::gather(MPI_Comm comm, const Hello& box, std::span<const EngineClump> mine,
                           std::span<const EngineSphere> spheres, const Records& records) {
  std::vector<EngineSphere> all = share(comm, spheres);
  std::sort(all.begin(), all.end(), by_carrier);
  std::unordered_map<std::int64_t, Known> known;
  for (const EngineClump& clump : mine) {
    const auto [first, last] =
        std::equal_range(all.begin(), all.end(), EngineSphere{.carrier = clump.id},
                         [](const auto& a, const auto& b) { return a.carrier < b.carrier; });
    const std::span<const EngineSphere> own(first, last);
    if (static_cast<int>(own.size()) < clump.spheres || own.empty()) continue;
    const auto before = known_.find(clump.id);
    const Known k = before != known_.end() ? before->second : measure(box, clump, own);
    known.emplace(clump.id, k);
    records.states.push_back({clump.id, clump.x, clump.v, clump.omega});
    records.shapes.push_back(
        {clump.id, k.radius, clump.mass, clump.inertia, clump.type, 0, kItself, k.volume});
    for (const EngineSphere& s : own) {
      records.states.push_back({s.id, s.x, s.v, s.omega});
      records.shapes.push_back({s.id, s.radius, 0.0, 0.0, s.type, 0, clump.id, 0.0});
    }
  }
  known_ = std::move(known);
}

std::vector<Load> ClumpCoupling::take(MPI_Comm comm, std::span<const Load> mine) {
  std::vector<Load> now = share(comm, mine);
  const auto by_id = [](const Load& a, const Load& b) { return a.id < b.id; };
  std::sort(now.begin(), now.end(), by_id);
  std::vector<Load> changes = now;
  for (Load& change : changes) {
    const auto before = std::lower_bound(loads_.begin(), loads_.end(), change, by_id);
    if (before == loads_.end() || before->id != change.id) continue;
    for (int k = 0; k < 3; ++k) {
      change.force[k] -= before->force[k];
      change.torque[k] -= before->torque[k];
    }
  }
  loads_ = std::move(now);
  return changes;
}

}  // namespace protocol
