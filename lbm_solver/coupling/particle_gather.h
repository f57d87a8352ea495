// SPDX-License-Identifier: GPL-2.0-or-later
/// What the ranks tell each other of particles: records of plain numbers, by name.
#pragma once

#include <cstring>
#include <span>
#include <type_traits>
#include <vector>

#include "lbm_solver/coupling/carrier.h"
#include "lbm_solver/field/decomposition.h"

namespace lbm {

/// Records of all ranks in rank order, on rank 0 (elsewhere empty). They travel as the doubles that
/// their bytes would be. Collective.
template <class Line>
std::vector<Line> collect_lines(const Decomposition& ranks, std::span<const Line> mine) {
  static_assert(std::is_trivially_copyable_v<Line> && sizeof(Line) % sizeof(double) == 0);
  std::vector<double> numbers(mine.size_bytes() / sizeof(double));
  if (!mine.empty()) std::memcpy(numbers.data(), mine.data(), mine.size_bytes());
  numbers = ranks.collect(numbers);
  std::vector<Line> all(numbers.size() * sizeof(double) / sizeof(Line));
  if (!all.empty())
    std::memcpy(static_cast<void*>(all.data()), numbers.data(), all.size() * sizeof(Line));
  return all;
}

/// The same on every rank. Collective.
template <class Line>
std::vector<Line> share_lines(const Decomposition& ranks, std::span<const Line> mine) {
  const std::vector<Line> at_root = collect_lines(ranks, mine);
  std::vector<double> numbers(at_root.size() * sizeof(Line) / sizeof(double));
  if (!at_root.empty())
    std::memcpy(numbers.data(), at_root.data(), numbers.size() * sizeof(double));
  ranks.broadcast(numbers);
  std::vector<Line> all(numbers.size() * sizeof(double) / sizeof(Line));
  if (!all.empty())
    std::memcpy(static_cast<void*>(all.data()), numbers.data(), all.size() * sizeof(Line));
  return all;
}

/// A particle as a rank knows it, with that rank's part of its load.
struct ParticleLine {
  protocol::Particle particle;  ///< of its id alone where the rank is not its home
  std::int64_t home = 0;        ///< 1: this rank holds its centre
  protocol::Load load;
};

/// Particles of the box, each once, in the order of their ids.
struct GatheredParticles {
  std::vector<protocol::Particle> particles;
  std::vector<protocol::Load> loads;  ///< whole
};
/// On rank 0; elsewhere empty. Without those whose home is outside the box. Collective.
GatheredParticles gather_particles(const Decomposition& ranks, std::span<const ParticleLine> mine);

/// A clump covers cells by its spheres alone: for those who look at radii, its own is 0.
void hide_hulls(std::vector<protocol::Particle>& particles);

/// A carrier's part of a load, and what its home alone knows.
struct LightLine {
  std::int64_t id = 0, home = 0;
  protocol::Vec3 force{}, torque{};
  Velocities mean_change;
};
/// Whole loads, with the home's mean change, of the carriers that `mine` names. Collective.
std::vector<LightLine> share_light(const Decomposition& ranks, std::span<const LightLine> mine);

}  // namespace lbm
