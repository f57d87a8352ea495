// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "lbm_solver/base/units.h"
#include "lbm_solver/field/decomposition.h"
#include "protocol/wire/messages.h"

namespace lbm {

/// Where the blocks have moved since the handshake: the solid still sends particles to the ranks
/// whose blocks it was told of, and from there they go to those that have the cells now. Of each
/// particle the rank that held its centre by the handshake gives it to whoever needs it, and gets
/// the parts of its load back, for the solid; a clump goes whole, by its carrier's centre. So the
/// wire and every engine on it stay as they are. Before the first move nothing is done.
class ParticleRelay {
 public:
  /// @param hello   of any rank: box, sides, reach
  /// @param agreed  blocks of the handshake
  ParticleRelay(protocol::Hello hello, const Units& units, const Decomposition& agreed);

  /// The ranks have these blocks from now on.
  void move_to(const Decomposition& ranks) { now_ = ranks; }

  /// Particles that touch this rank's cells, in the order of their ids. Valid until the next.
  /// @param from_wire  those that came to this rank, in the order of their ids. Collective.
  std::span<const protocol::Particle> arrive(std::span<const protocol::Particle> from_wire);
  /// Loads in the order in which the particles came from the wire; nothing for one whose centre is
  /// another rank's. @param loads  of those that `arrive` returned, this rank's parts. Collective.
  std::span<const protocol::Load> give_back(std::span<const protocol::Load> loads);

 private:
  std::vector<std::size_t> carriers_of(std::span<const protocol::Particle> particles) const;

  protocol::Hello hello_;
  Units units_;
  Decomposition agreed_;
  std::optional<Decomposition> now_;  // empty before the first move
  std::vector<protocol::Particle> particles_;
  std::vector<std::vector<std::size_t>> given_;  // [rank] which of those on the wire
  std::vector<std::vector<std::size_t>> taken_;  // [rank] which of particles_
  std::vector<protocol::Load> loads_;            // for the wire; of particles that have come
};

}  // namespace lbm
