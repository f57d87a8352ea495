// SPDX-License-Identifier: GPL-2.0-or-later
#include "lbm_solver/coupling/particle_relay.h"

#include <algorithm>
#include <numeric>
#include <type_traits>
#include <unordered_map>
#include <utility>

#include "lbm_solver/coupling/carrier.h"
#include "lbm_solver/coupling/handshake.h"
#include "protocol/wire/clumps.h"
#include "protocol/wire/routing.h"

namespace lbm {
namespace {

/// Gives each rank a list, and takes one from each. @return  [rank] Collective.
template <class T>
std::vector<std::vector<T>> exchange(MPI_Comm comm, const std::vector<std::vector<T>>& gives) {
  static_assert(std::is_trivially_copyable_v<T>);
  const std::size_t size = gives.size();
  const auto bytes_of = [](const std::vector<T>& list) {
    return static_cast<int>(list.size() * sizeof(T));
  };
  std::vector<int> out(size), in(size), out_at(size, 0), in_at(size, 0);
  std::vector<T> all;
  for (std::size_t r = 0; r < size; ++r) {
    out[r] = bytes_of(gives[r]);
    all.insert(all.end(), gives[r].begin(), gives[r].end());
  }
  MPI_Alltoall(out.data(), 1, MPI_INT, in.data(), 1, MPI_INT, comm);
  std::partial_sum(out.begin(), out.end() - 1, out_at.begin() + 1);
  std::partial_sum(in.begin(), in.end() - 1, in_at.begin() + 1);
  std::vector<T> arrived(static_cast<std::size_t>(in_at.back() + in.back()) / sizeof(T));
  MPI_Alltoallv(all.data(), out.data(), out_at.data(), MPI_BYTE, arrived.data(), in.data(),
                in_at.data(), MPI_BYTE, comm);
  std::vector<std::vector<T>> takes(size);
  auto at = arrived.begin();
  for (std::size_t r = 0; r < size; ++r) {
    const auto end = at + static_cast<std::ptrdiff_t>(in[r] / sizeof(T));
    takes[r].assign(std::exchange(at, end), end);
  }
  return takes;
}

void add_to(protocol::Vec3& sum, const protocol::Vec3& part) {
  for (int k = 0; k < 3; ++k) sum[k] += part[k];
}

}  // namespace

ParticleRelay::ParticleRelay(protocol::Hello hello, const Units& units, const Decomposition& agreed)
    : hello_(std::move(hello)), units_(units), agreed_(agreed) {
  hello_.variables.clear();  // there may be thousands
}

/// Of each particle the one whose ball says which ranks get it: itself, or its clump's carrier.
std::vector<std::size_t> ParticleRelay::carriers_of(
    std::span<const protocol::Particle> particles) const {
  std::vector<std::size_t> carrier(particles.size());
  std::iota(carrier.begin(), carrier.end(), std::size_t{0});
  const auto part = [](const auto& p) { return protocol::is_part(p.shape); };
  if (std::ranges::none_of(particles, part)) return carrier;
  std::unordered_map<std::int64_t, std::size_t> place;
  for (std::size_t i = 0; i < particles.size(); ++i) place.emplace(particles[i].state.id, i);
  for (std::size_t i = 0; i < particles.size(); ++i)
    if (part(particles[i])) carrier[i] = place.at(particles[i].shape.carrier);
  return carrier;
}

std::span<const protocol::Particle> ParticleRelay::arrive(
    std::span<const protocol::Particle> from_wire) {
  if (!now_) return from_wire;
  const std::vector<std::size_t> carrier = carriers_of(from_wire);
  std::vector<char> home(from_wire.size());
  for (std::size_t i = 0; i < home.size(); ++i)
    home[i] = holds(agreed_.domain(), agreed_.cells(),
                    units_.to_lattice_position(to_vec3(from_wire[carrier[i]].state.x)));
  const auto size = static_cast<std::size_t>(now_->size());
  given_.assign(size, {});
  std::vector<std::vector<protocol::Particle>> gives(size);
  for (std::size_t r = 0; r < size; ++r) {
    set_subdomain(units_, now_->domain(), now_->cells_of(static_cast<int>(r)), hello_);
    for (std::size_t i = 0; i < home.size(); ++i) {
      const auto& [state, shape] = from_wire[carrier[i]];
      if (!home[i] || !protocol::touches(hello_, state.x, shape.radius)) continue;
      given_[r].push_back(i);
      gives[r].push_back(from_wire[i]);
    }
  }
  loads_.assign(from_wire.size(), {});
  for (std::size_t i = 0; i < loads_.size(); ++i) loads_[i].id = from_wire[i].state.id;

  struct Origin {
    std::int64_t id;
    std::size_t rank, number;
  };
  std::vector<Origin> origins;
  const auto takes = exchange(now_->comm(), gives);
  taken_.assign(size, {});
  for (std::size_t r = 0; r < size; ++r) {
    taken_[r].resize(takes[r].size());
    for (std::size_t k = 0; k < takes[r].size(); ++k)
      origins.push_back({takes[r][k].state.id, r, k});
  }
  std::ranges::sort(origins, {}, &Origin::id);
  particles_.clear();
  for (const Origin& o : origins) {
    taken_[o.rank][o.number] = particles_.size();
    particles_.push_back(takes[o.rank][o.number]);
  }
  return particles_;
}

std::span<const protocol::Load> ParticleRelay::give_back(std::span<const protocol::Load> loads) {
  if (!now_) return loads;
  std::vector<std::vector<protocol::Load>> gives(taken_.size());
  for (std::size_t r = 0; r < taken_.size(); ++r)
    for (const std::size_t i : taken_[r]) gives[r].push_back(loads[i]);
  const auto takes = exchange(now_->comm(), gives);
  for (std::size_t r = 0; r < takes.size(); ++r)  // in rank order, as the solid adds them
    for (std::size_t k = 0; k < takes[r].size(); ++k) {
      protocol::Load& sum = loads_[given_[r][k]];
      add_to(sum.force, takes[r][k].force);
      add_to(sum.torque, takes[r][k].torque);
    }
  return loads_;
}

}  // namespace lbm
