// SPDX-License-Identifier: GPL-2.0-or-later
#include "lbm_solver/coupling/particles.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <unordered_map>

namespace lbm {

namespace {

constexpr double kAverage = 0.2;  // weight of the latest interval in a mean acceleration

}  // namespace

Particles::Particles(const Units& units, const Scene& scene)
    : units_(units),
      fluid_(scene.fluid),
      coupling_(*scene.coupling),
      hydraulic_ratio_(scene.particles->hydraulic_ratio) {}

void Particles::arrive(std::span<const protocol::Particle> particles, double interval) {
  past_.clear();
  for (std::size_t i = 0; i < particles_.size(); ++i) {
    const protocol::State& s = particles_[i].state;
    const protocol::Load sent = i < loads_.size() ? loads_[i] : protocol::Load{};
    past_.push_back({s.id, {s.v, s.omega}, sent.force, sent.torque, mean_change_[i]});
  }
  std::unordered_map<std::int64_t, const Past*> by_id;  // only where the order has changed
  const auto past_of = [&](std::size_t i, std::int64_t id) -> const Past* {
    if (i < past_.size() && past_[i].id == id) return &past_[i];
    if (by_id.empty())
      for (const Past& p : past_) by_id.emplace(p.id, &p);
    const auto found = by_id.find(id);
    return found == by_id.end() ? nullptr : found->second;
  };
  interval_ = interval;
  particles_.assign(particles.begin(), particles.end());
  change_.assign(particles.size(), Motion{});
  mean_change_.assign(particles.size(), Motion{});
  before_.assign(particles.size(), nullptr);
  for (std::size_t i = 0; i < particles.size(); ++i) {
    const protocol::State& s = particles[i].state;
    before_[i] = past_of(i, s.id);
    if (!before_[i]) continue;
    const Past& past = *before_[i];
    for (int k = 0; k < 3; ++k) {
      change_[i].v[k] = s.v[k] - past.motion.v[k];
      change_[i].omega[k] = s.omega[k] - past.motion.omega[k];
      mean_change_[i].v[k] = std::lerp(past.mean_change.v[k], change_[i].v[k], kAverage);
      mean_change_[i].omega[k] =
          std::lerp(past.mean_change.omega[k], change_[i].omega[k], kAverage);
    }
  }
  loads_.clear();
  sums_.assign(particles.size(), DiscLoad{});
}

double Particles::radius(std::size_t i) const {
  const auto type = static_cast<std::size_t>(std::max<std::int64_t>(1, particles_[i].shape.type));
  return particles_[i].shape.radius * hydraulic_ratio_[std::min(type, hydraulic_ratio_.size()) - 1];
}

std::vector<double> Particles::masses() const {
  std::vector<double> masses;
  for (const auto& p : particles_) masses.push_back(p.shape.mass / units_.mass());
  return masses;
}

std::span<const Disc> Particles::discs(double elapsed) {
  discs_.resize(particles_.size());
  for (std::size_t i = 0; i < particles_.size(); ++i) {
    const protocol::State& s = particles_[i].state;
    const Vec2 velocity(s.v[0], s.v[1]);
    const Vec2 centre = Vec2(s.x[0], s.x[1]) + elapsed * velocity;
    discs_[i] = {s.id, units_.to_lattice_position(centre), radius(i) / units_.dx,
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
  const double r = radius(i), fluid_mass = displaced_mass(i);
  if (coupling_.inner_inertia) {
    const double fluid_inertia = 0.5 * fluid_mass * r * r;
    const Motion& change = virtual_mass(i) > 0.0 ? mean_change_[i] : change_[i];
    for (int k = 0; k < 2; ++k) load.force[k] += fluid_mass * change.v[k] / interval_;
    load.torque[2] += fluid_inertia * change.omega[2] / interval_;
  }
  if (coupling_.buoyancy == protocol::Buoyancy::ByFluid)
    for (int k = 0; k < 2; ++k) load.force[k] -= fluid_mass * fluid_.gravity[k];
  return load;
}

double Particles::displaced_mass(std::size_t i) const {
  const double r = radius(i);
  return fluid_.density * std::numbers::pi * r * r * units_.depth;
}

double Particles::virtual_mass(std::size_t i) const {
  if (coupling_.virtual_mass) return *coupling_.virtual_mass;
  const double tau = 0.5 + 3.0 * fluid_.viscosity * units_.dt / (units_.dx * units_.dx);
  const double limit = tau > kViscousTau ? kViscousRatio : kLightRatio;
  return particles_[i].shape.mass < limit * displaced_mass(i) ? kVirtualMass : 0.0;
}

void Particles::add_virtual_mass(std::size_t i, protocol::Load& load) const {
  const protocol::Shape& shape = particles_[i].shape;
  const double mass = virtual_mass(i) * displaced_mass(i), r = radius(i);
  if (mass == 0.0) return;
  const auto blend = [](double load, double acceleration, double others, double own, double extra) {
    return (own * (load + extra * acceleration) - extra * others) / (own + extra);
  };
  for (int k = 0; k < 2; ++k) {
    const double acceleration = change_[i].v[k] / interval_;
    const double others = before_[i] ? shape.mass * acceleration - before_[i]->force[k]
                                     : shape.mass * fluid_.gravity[k];
    load.force[k] = blend(load.force[k], acceleration, others, shape.mass, mass);
  }
  const double spin_up = change_[i].omega[2] / interval_;
  const double others = before_[i] ? shape.inertia * spin_up - before_[i]->torque[2] : 0.0;
  load.torque[2] = blend(load.torque[2], spin_up, others, shape.inertia, 0.5 * mass * r * r);
}

std::span<const protocol::Load> Particles::mean_loads(int steps) {
  loads_.resize(particles_.size());
  for (std::size_t i = 0; i < particles_.size(); ++i) {
    loads_[i] = hydrodynamic(i, steps);
    add_virtual_mass(i, loads_[i]);
  }
  return loads_;
}

namespace {

constexpr std::size_t kKept = 19;  // id and six vectors

void keep(std::vector<double>& memory, std::initializer_list<protocol::Vec3> vectors) {
  for (const protocol::Vec3& v : vectors) memory.insert(memory.end(), v.begin(), v.end());
}

}  // namespace

std::vector<double> Particles::memory() const {
  std::vector<double> memory;
  for (std::size_t i = 0; i < particles_.size(); ++i) {
    const protocol::State& s = particles_[i].state;
    memory.push_back(static_cast<double>(s.id));
    keep(memory, {s.v, s.omega, loads_[i].force, loads_[i].torque, mean_change_[i].v,
                  mean_change_[i].omega});
  }
  return memory;
}

void Particles::restore(std::span<const double> memory) {
  if (memory.size() % kKept != 0)
    throw std::invalid_argument("'particles' of a checkpoint has another size");
  const std::size_t n = memory.size() / kKept;
  particles_.assign(n, {});
  loads_.assign(n, {});
  mean_change_.assign(n, {});
  for (std::size_t i = 0; i < n; ++i) {
    const double* from = &memory[kKept * i];
    protocol::State& s = particles_[i].state;
    s.id = loads_[i].id = static_cast<std::int64_t>(*from++);
    for (protocol::Vec3* v : {&s.v, &s.omega, &loads_[i].force, &loads_[i].torque,
                              &mean_change_[i].v, &mean_change_[i].omega}) {
      std::copy_n(from, 3, v->begin());
      from += 3;
    }
  }
}

double Particles::max_speed() const {
  double largest = 0.0;
  for (const auto& p : particles_)
    largest = std::max(largest, std::hypot(p.state.v[0], p.state.v[1]) +
                                    std::abs(p.state.omega[2]) * p.shape.radius);
  return largest;
}

}  // namespace lbm
