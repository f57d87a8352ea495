// SPDX-License-Identifier: GPL-2.0-or-later
#include "lbm_solver/coupling/particles.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <map>
#include <numbers>
#include <unordered_map>

#include "lbm_solver/immersed/solid_term.h"

namespace lbm {

namespace {

Vec3 to_vec3(const protocol::Vec3& v) {
  return {v[0], v[1], v[2]};
}

/// One number for whom a body is: another particle with the same id is another body.
std::int64_t body_id(const protocol::Particle& p) {
  return static_cast<std::int64_t>(static_cast<std::uint64_t>(p.state.id) +
                                   (static_cast<std::uint64_t>(p.shape.epoch) << 32));
}

double relaxation_time(const Units& units, const FluidScene& fluid) {
  return 0.5 + 3.0 * fluid.viscosity * units.dt / (units.dx * units.dx);
}

}  // namespace

LightRule light_rule(const std::string& solid_term, double tau) {
  if (by_resistance(solid_term)) return {tau < 0.525 ? 1.5 : 0.99, 1.0, 0.05};
  return {tau > 0.8 ? 2.0 : 0.9, 2.0, 0.2};
}

Particles::Particles(const Units& units, const Scene& scene, const Decomposition& ranks,
                     const std::string& solid_term)
    : units_(units),
      fluid_(scene.fluid),
      coupling_(*scene.coupling),
      hydraulic_ratio_(scene.particles->hydraulic_ratio),
      ranks_(ranks),
      light_(light_rule(solid_term, relaxation_time(units, scene.fluid))),
      flat_(ranks.domain().dimension() == 2),
      light_about_(coupling_.virtual_mass
                       ? *coupling_.virtual_mass > 0.0
                       : scene.particles->density.lo < light_.ratio * fluid_.density) {}

std::vector<Particles::Past> Particles::present() const {
  std::vector<Past> all;
  for (std::size_t i = 0; i < particles_.size(); ++i) {
    const protocol::State& s = particles_[i].state;
    const auto& sent = whole_.empty() ? loads_ : whole_;
    const protocol::Load load = i < sent.size() ? sent[i] : protocol::Load{};
    all.push_back({s.id,
                   particles_[i].shape.epoch,
                   {s.v, s.omega},
                   load.force,
                   load.torque,
                   mean_change_[i]});
  }
  return all;
}

void Particles::arrive(std::span<const protocol::Particle> particles, double interval) {
  past_ = present();
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
    if (before_[i] && before_[i]->epoch != particles[i].shape.epoch) before_[i] = nullptr;
    if (!before_[i]) continue;
    const Past& past = *before_[i];
    const auto change = [this](const protocol::Vec3& now, const protocol::Vec3& past,
                               const protocol::Vec3& past_mean, protocol::Vec3& change,
                               protocol::Vec3& mean) {
      // Let go from rest, a particle's acceleration is new but lasts: the mean begins with it.
      // (With any other first change it would give back more momentum than the fluid inside has.)
      const protocol::Vec3 none{};
      const double weight = past_mean == none && past == none ? 1.0 : light_.mean_weight;
      for (int k = 0; k < 3; ++k) {
        change[k] = now[k] - past[k];
        mean[k] = std::lerp(past_mean[k], change[k], weight);
      }
    };
    change(s.v, past.motion.v, past.mean_change.v, change_[i].v, mean_change_[i].v);
    change(s.omega, past.motion.omega, past.mean_change.omega, change_[i].omega,
           mean_change_[i].omega);
  }
  loads_before_.swap(loads_);
  whole_before_ = std::exchange(whole_now_, false);
  loads_known_ = false;
  loads_.clear();
  whole_.clear();
  sums_.assign(particles.size(), BodyLoad{});
}

double Particles::covered_radius(std::size_t i) const {
  const auto type = static_cast<std::size_t>(std::max<std::int64_t>(1, particles_[i].shape.type));
  return particles_[i].shape.radius * hydraulic_ratio_[std::min(type, hydraulic_ratio_.size()) - 1];
}

bool Particles::at_home(std::size_t i) const {
  const Vec3 centre = units_.to_lattice_position(to_vec3(particles_[i].state.x));
  return ranks_.alone() || holds(ranks_.domain(), ranks_.cells(), centre);
}

Vec3 Particles::weight_in_fluid() const {
  double mass = 0.0;
  for (std::size_t i = 0; i < particles_.size(); ++i) {
    if (!at_home(i)) continue;
    mass += particles_[i].shape.mass;
    if (coupling_.buoyancy != protocol::Buoyancy::None) mass -= displaced_mass(i);
  }
  return mass * fluid_.gravity;
}

std::vector<double> Particles::masses() const {
  std::vector<double> masses;
  for (const auto& p : particles_) masses.push_back(p.shape.mass / units_.mass());
  return masses;
}

std::span<const Body> Particles::bodies(double elapsed) {
  bodies_.resize(particles_.size());
  for (std::size_t i = 0; i < particles_.size(); ++i) {
    const protocol::State& s = particles_[i].state;
    const Vec3 velocity = to_vec3(s.v), centre = to_vec3(s.x) + elapsed * velocity;
    Body& b = bodies_[i];
    b = {body_id(particles_[i]), units_.to_lattice_position(centre), covered_radius(i) / units_.dx,
         units_.to_lattice_velocity(velocity), units_.to_lattice_spin(to_vec3(s.omega))};
    if (!flat_) continue;
    b.centre.z() = b.velocity.z() = 0.0;
    b.spin = b.spin.z();
  }
  return bodies_;
}

void Particles::add(std::span<const BodyLoad> loads) {
  for (std::size_t i = 0; i < loads.size(); ++i) {
    sums_[i].force += loads[i].force;
    sums_[i].torque += loads[i].torque;
  }
}

protocol::Load Particles::hydrodynamic(std::size_t i, int steps) const {
  const Vec3 force = sums_[i].force * (units_.force() / steps);
  const Vec3 torque = sums_[i].torque * (units_.torque() / steps);
  protocol::Load load{particles_[i].state.id,
                      {force.x(), force.y(), force.z()},
                      {torque.x(), torque.y(), torque.z()}};
  if (!at_home(i)) return load;
  const int last = flat_ ? 2 : 3;  // axes of a force
  if (coupling_.inner_inertia) {
    const double mass = covered_mass(i), inertia = mass * inertia_per_mass(i);
    const Motion& change = virtual_mass(i) > 0.0 ? mean_change_[i] : change_[i];
    for (int k = 0; k < last; ++k) load.force[k] += mass * change.v[k] / interval_;
    for (int k = flat_ ? 2 : 0; k < 3; ++k) load.torque[k] += inertia * change.omega[k] / interval_;
  }
  if (coupling_.buoyancy == protocol::Buoyancy::ByFluid)
    for (int k = 0; k < last; ++k) load.force[k] -= displaced_mass(i) * fluid_.gravity[k];
  return load;
}

double Particles::fluid_mass(double radius) const {
  return fluid_.density * std::numbers::pi * radius * radius *
         (flat_ ? units_.depth : 4.0 / 3.0 * radius);
}

double Particles::covered_mass(std::size_t i) const {
  return fluid_mass(covered_radius(i));
}

double Particles::displaced_mass(std::size_t i) const {
  return fluid_mass(particles_[i].shape.radius);
}

double Particles::inertia_per_mass(std::size_t i) const {
  const double r = covered_radius(i);
  return (flat_ ? 0.5 : 0.4) * r * r;
}

double Particles::virtual_mass(std::size_t i) const {
  if (!light_about_) return 0.0;
  if (coupling_.virtual_mass) return *coupling_.virtual_mass;
  return particles_[i].shape.mass < light_.ratio * covered_mass(i) ? light_.virtual_mass : 0.0;
}

void Particles::add_virtual_mass(std::size_t i, protocol::Load& load) const {
  const protocol::Shape& shape = particles_[i].shape;
  const double mass = virtual_mass(i) * covered_mass(i);
  if (mass == 0.0) return;
  const bool home = at_home(i);
  const auto blend = [home](double load, double acceleration, double others, double own,
                            double extra) {
    const double known = home ? own * extra * acceleration - extra * others : 0.0;
    return (own * load + known) / (own + extra);
  };
  for (int k = 0; k < (flat_ ? 2 : 3); ++k) {
    const double acceleration = change_[i].v[k] / interval_;
    const double others = before_[i] ? shape.mass * acceleration - before_[i]->force[k]
                                     : shape.mass * fluid_.gravity[k];
    load.force[k] = blend(load.force[k], acceleration, others, shape.mass, mass);
  }
  for (int k = flat_ ? 2 : 0; k < 3; ++k) {
    const double spin_up = change_[i].omega[k] / interval_;
    const double others = before_[i] ? shape.inertia * spin_up - before_[i]->torque[k] : 0.0;
    load.torque[k] =
        blend(load.torque[k], spin_up, others, shape.inertia, mass * inertia_per_mass(i));
  }
}

std::span<const protocol::Load> Particles::mean_loads(int steps) {
  loads_known_ = true;
  loads_.resize(particles_.size());
  for (std::size_t i = 0; i < particles_.size(); ++i) {
    loads_[i] = hydrodynamic(i, steps);
    add_virtual_mass(i, loads_[i]);
  }
  if (light_about_ && !ranks_.alone()) share_light();
  return loads_;
}

namespace {

void keep(std::vector<double>& memory, std::initializer_list<protocol::Vec3> vectors) {
  for (const protocol::Vec3& v : vectors) memory.insert(memory.end(), v.begin(), v.end());
}

void add_to(protocol::Vec3& sum, const double* part) {
  for (int k = 0; k < 3; ++k) sum[k] += part[k];
}

}  // namespace

/// The next interval's virtual mass needs the whole load of this one, and the home's mean change.
void Particles::share_light() {
  constexpr std::size_t line = 14;  // id, home, force, torque, mean change
  std::vector<double> lines;
  for (std::size_t i = 0; i < particles_.size(); ++i) {
    lines.insert(lines.end(), {static_cast<double>(loads_[i].id), at_home(i) ? 1.0 : 0.0});
    keep(lines, {loads_[i].force, loads_[i].torque, mean_change_[i].v, mean_change_[i].omega});
  }
  lines = ranks_.collect(lines);
  ranks_.broadcast(lines);
  std::unordered_map<std::int64_t, std::size_t> mine;
  whole_.assign(particles_.size(), {});
  for (std::size_t i = 0; i < particles_.size(); ++i) {
    mine.emplace(loads_[i].id, i);
    whole_[i].id = loads_[i].id;
  }
  for (const double* l = lines.data(); l < lines.data() + lines.size(); l += line) {
    const auto found = mine.find(static_cast<std::int64_t>(l[0]));
    if (found == mine.end()) continue;
    add_to(whole_[found->second].force, l + 2);
    add_to(whole_[found->second].torque, l + 5);
    if (l[1] == 0.0) continue;
    std::copy_n(l + 8, 3, mean_change_[found->second].v.begin());
    std::copy_n(l + 11, 3, mean_change_[found->second].omega.begin());
  }
}

/// This rank's parts in the order of its particles, then those of particles that have left it.
std::vector<protocol::Load> Particles::latest_loads() const {
  if (loads_known_) return loads_;
  std::unordered_map<std::int64_t, std::size_t> at;
  std::vector<protocol::Load> latest;
  for (const auto& p : particles_) {
    at.emplace(p.state.id, latest.size());
    latest.push_back({p.state.id, {}, {}});
  }
  for (const protocol::Load& load : loads_before_) {
    const auto found = at.find(load.id);
    if (whole_before_ && (found == at.end() || !at_home(found->second))) continue;
    if (found == at.end())
      latest.push_back(load);
    else if (before_[found->second])  // else of the one that had its id before
      latest[found->second] = load;
  }
  return latest;
}

Particles::Everything Particles::gather() const {
  Everything all;
  const std::vector<protocol::Load> loads = latest_loads();
  if (ranks_.alone()) {
    all.particles = particles_;
    all.loads.assign(loads.begin(), loads.begin() + static_cast<std::ptrdiff_t>(size()));
    return all;
  }
  constexpr std::size_t line = 21;
  std::vector<double> lines;
  for (std::size_t i = 0; i < particles_.size(); ++i) {
    const auto& [s, shape] = particles_[i];
    lines.insert(lines.end(), {static_cast<double>(s.id), at_home(i) ? 1.0 : 0.0});
    keep(lines, {s.x, s.v, s.omega});
    lines.insert(lines.end(),
                 {shape.radius, shape.mass, shape.inertia, static_cast<double>(shape.type)});
    keep(lines, {loads[i].force, loads[i].torque});
  }
  for (std::size_t i = size(); i < loads.size(); ++i) {
    lines.insert(lines.end(), {static_cast<double>(loads[i].id), 0.0});
    lines.insert(lines.end(), 13, 0.0);
    keep(lines, {loads[i].force, loads[i].torque});
  }
  lines = ranks_.collect(lines);
  std::map<std::int64_t, std::pair<protocol::Particle, protocol::Load>> by_id;
  for (const double* l = lines.data(); l < lines.data() + lines.size(); l += line) {
    const auto id = static_cast<std::int64_t>(l[0]);
    auto& [particle, load] = by_id[id];
    load.id = id;
    add_to(load.force, l + 15);
    add_to(load.torque, l + 18);
    if (l[1] == 0.0) continue;
    protocol::State& s = particle.state;
    s.id = id;
    std::copy_n(l + 2, 3, s.x.begin());
    std::copy_n(l + 5, 3, s.v.begin());
    std::copy_n(l + 8, 3, s.omega.begin());
    particle.shape = {id, l[11], l[12], l[13], static_cast<std::int64_t>(l[14])};
  }
  for (const auto& [id, both] : by_id) {
    if (both.first.state.id != id) continue;  // its home is outside the box
    all.particles.push_back(both.first);
    all.loads.push_back(both.second);
  }
  return all;
}

constexpr std::array<Particles::Kept, 6> Particles::kKept{
    {{"velocities", [](Past& p) -> protocol::Vec3& { return p.motion.v; }},
     {"angular_velocities", [](Past& p) -> protocol::Vec3& { return p.motion.omega; }},
     {"forces", [](Past& p) -> protocol::Vec3& { return p.force; }},
     {"torques", [](Past& p) -> protocol::Vec3& { return p.torque; }},
     {"mean_velocity_changes", [](Past& p) -> protocol::Vec3& { return p.mean_change.v; }},
     {"mean_angular_velocity_changes",
      [](Past& p) -> protocol::Vec3& { return p.mean_change.omega; }}}};

Record Particles::save() const {
  std::vector<double> lines;
  std::vector<Past> all = present();
  const Everything whole = gather();  // of the loads every rank has a part
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (!at_home(i)) continue;
    lines.insert(lines.end(),
                 {std::bit_cast<double>(all[i].id), std::bit_cast<double>(all[i].epoch)});
    for (const Kept& kept : kKept) keep(lines, {kept.of(all[i])});
  }
  lines = ranks_.collect(lines);
  constexpr std::size_t integers = 2;
  const std::size_t line = integers + 3 * kKept.size(), n = lines.size() / line;
  std::vector<std::int64_t> ids(n), epochs(n);
  for (std::size_t i = 0; i < n; ++i) {
    ids[i] = std::bit_cast<std::int64_t>(lines[i * line]);
    epochs[i] = std::bit_cast<std::int64_t>(lines[i * line + 1]);
  }
  std::unordered_map<std::int64_t, const protocol::Load*> load_of;
  if (whole_.empty())
    for (const protocol::Load& load : whole.loads) load_of.emplace(load.id, &load);
  Record record;
  for (std::size_t k = 0; k < kKept.size(); ++k) {
    const std::string name = kKept[k].name;
    std::vector<double> vectors;
    for (std::size_t i = 0; i < n; ++i) {
      const double* from = &lines[i * line + integers + 3 * k];
      const auto load = load_of.find(ids[i]);
      if (load != load_of.end() && name == "forces") from = load->second->force.data();
      if (load != load_of.end() && name == "torques") from = load->second->torque.data();
      vectors.insert(vectors.end(), from, from + 3);
    }
    record.set(name, std::move(vectors));
  }
  record.set("ids", std::move(ids));
  record.set("epochs", std::move(epochs));
  return record;
}

void Particles::load(const Record& record) {
  const auto& ids = record.get<std::vector<std::int64_t>>("ids");
  const auto& epochs = record.list<std::int64_t>("epochs", ids.size());
  std::vector<Past> all(ids.size());
  for (const Kept& kept : kKept) {
    const auto& vectors = record.list<double>(kept.name, 3 * ids.size());
    for (std::size_t i = 0; i < all.size(); ++i)
      std::copy_n(&vectors[3 * i], 3, kept.of(all[i]).begin());
  }
  particles_.assign(all.size(), {});
  loads_.clear();
  whole_now_ = !ranks_.alone();
  mean_change_.clear();
  for (std::size_t i = 0; i < all.size(); ++i) {
    protocol::State& s = particles_[i].state;
    s.id = ids[i];
    particles_[i].shape.epoch = epochs[i];
    s.v = all[i].motion.v;
    s.omega = all[i].motion.omega;
    loads_.push_back({ids[i], all[i].force, all[i].torque});
    mean_change_.push_back(all[i].mean_change);
  }
}

double Particles::max_speed() const {
  double largest = 0.0;
  for (const auto& p : particles_)
    largest = std::max(largest,
                       to_vec3(p.state.v).norm() + to_vec3(p.state.omega).norm() * p.shape.radius);
  return largest;
}

}  // namespace lbm
