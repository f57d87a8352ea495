// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <span>
#include <unordered_map>
#include <vector>

#include "lbm_solver/base/scene.h"
#include "lbm_solver/immersed/disc.h"
#include "protocol/session.h"

namespace lbm {

/// The solid's particles between wire and lattice: SI states in, discs in lattice units out,
/// lattice loads in, SI loads out.
///
/// The force that a covered region receives from the lattice includes the change of momentum of the
/// fluid inside it, m_f dU/dt. The solid integrates its own mass only, so that part is given back:
///   F = mean(F_lattice) + m_f (U_k - U_{k-1})/T + buoyancy,   m_f = rho_f pi R² depth,
///   T = mean(T_lattice) + I_f (ω_k - ω_{k-1})/T,              I_f = ½ m_f R².
class Particles {
 public:
  Particles(const Units& units, const FluidScene& fluid, const CouplingScene& coupling);

  /// Takes the particles of a new interval of `interval` seconds.
  void arrive(std::span<const protocol::Particle> particles, double interval);

  std::size_t size() const { return particles_.size(); }
  std::span<const protocol::Particle> states() const { return particles_; }

  /// Where the discs are `elapsed` seconds after the interval began, moving on straight.
  std::span<const Disc> discs(double elapsed);

  /// Adds the loads of one fluid step.
  void add(std::span<const DiscLoad> loads);

  /// Mean load over `steps` fluid steps, complete, for the wire.
  std::span<const protocol::Load> mean_loads(int steps);
  /// What mean_loads returned last, in the order of states().
  std::span<const protocol::Load> last_loads() const { return loads_; }

  double max_speed() const;  ///< [m/s], of centre and rim

 private:
  struct Motion {
    protocol::Vec3 v, omega;
  };
  protocol::Load hydrodynamic(std::size_t i, int steps) const;

  Units units_;
  FluidScene fluid_;
  CouplingScene coupling_;
  double interval_ = 0.0;
  std::vector<protocol::Particle> particles_;
  std::vector<Motion> change_;  // of velocities since the interval before; 0 for a new particle
  std::unordered_map<std::int64_t, Motion> before_;
  std::vector<Disc> discs_;
  std::vector<DiscLoad> sums_;
  std::vector<protocol::Load> loads_;
};

}  // namespace lbm
