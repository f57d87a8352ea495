// SPDX-License-Identifier: GPL-2.0-or-later
#include "lbm_solver/coupling/particles.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace lbm {

Particles::Particles(const Units& units, const FluidScene& fluid, const CouplingScene& coupling)
    : units_(units), fluid_(fluid), coupling_(coupling) {}

void Particles::arrive(std::span<const protocol::Particle> particles, double interval) {
  interval_ = interval;
  particles_.assign(particles.begin(), particles.end());
  change_.assign(particles.size(), Motion{});
  std::unordered_map<std::int64_t, Motion> now;
  for (std::size_t i = 0; i < particles.size(); ++i) {
    const protocol::State& s = particles[i].state;
    now.emplace(s.id, Motion{s.v, s.omega});
    const auto before = before_.find(s.id);
    if (before == before_.end()) continue;
    for (int k = 0; k < 3; ++k) {
      change_[i].v[k] = s.v[k] - before->second.v[k];
      change_[i].omega[k] = s.omega[k] - before->second.omega[k];
    }
  }
  before_ = std::move(now);
  sums_.assign(particles.size(), DiscLoad{});
}

std::span<const Disc> Particles::discs(double elapsed) {
  discs_.resize(particles_.size());
  for (std::size_t i = 0; i < particles_.size(); ++i) {
    const protocol::State& s = particles_[i].state;
    const Vec2 velocity(s.v[0], s.v[1]);
    const Vec2 centre = Vec2(s.x[0], s.x[1]) + elapsed * velocity;
    discs_[i] = {s.id, units_.to_lattice_position(centre), particles_[i].shape.radius / units_.dx,
                 units_.to_lattice_velocity(velocity), units_.to_lattice_spin(s.omega[2])};
  }
  return discs_;
}

void Particles::add(std::span<const DiscLoad> loads) {
  for (std::size_t i = 0; i < loads.size(); ++i) {
    sums_[i].force += loads[i].force;
    sums_[i].torque += loads[i].torque;
  }
}

protocol::Load Particles::hydrodynamic(std::size_t i, int steps) const {
  const Vec2 force = sums_[i].force * (units_.force() / steps);
  const double torque = sums_[i].torque * (units_.torque() / steps);
  protocol::Load load{particles_[i].state.id, {force.x(), force.y(), 0.0}, {0.0, 0.0, torque}};
  const double radius = particles_[i].shape.radius;
  const double fluid_mass = fluid_.density * std::numbers::pi * radius * radius * units_.depth;
  if (coupling_.inner_inertia) {
    const double fluid_inertia = 0.5 * fluid_mass * radius * radius;
    for (int k = 0; k < 2; ++k) load.force[k] += fluid_mass * change_[i].v[k] / interval_;
    load.torque[2] += fluid_inertia * change_[i].omega[2] / interval_;
  }
  if (coupling_.buoyancy == protocol::Buoyancy::ByFluid)
    for (int k = 0; k < 2; ++k) load.force[k] -= fluid_mass * fluid_.gravity[k];
  return load;
}

std::span<const protocol::Load> Particles::mean_loads(int steps) {
  loads_.resize(particles_.size());
  for (std::size_t i = 0; i < particles_.size(); ++i) loads_[i] = hydrodynamic(i, steps);
  return loads_;
}

double Particles::max_speed() const {
  double largest = 0.0;
  for (const auto& p : particles_)
    largest = std::max(largest, std::hypot(p.state.v[0], p.state.v[1]) +
                                    std::abs(p.state.omega[2]) * p.shape.radius);
  return largest;
}

}  // namespace lbm
