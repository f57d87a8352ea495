// SPDX-License-Identifier: GPL-2.0-or-later
#include "lbm_solver/coupling/particles.h"

#include <algorithm>
#include <cmath>
#include <unordered_map>
#include <utility>

#include "lbm_solver/coupling/particle_state.h"
#include "protocol/wire/clumps.h"

namespace lbm {

namespace {

constexpr std::size_t kNone = static_cast<std::size_t>(-1);

/// One number for whom a body is: another particle with the same id is another body.
std::int64_t body_id(const protocol::Particle& p) {
  return static_cast<std::int64_t>(static_cast<std::uint64_t>(p.state.id) +
                                   (static_cast<std::uint64_t>(p.shape.epoch) << 32));
}

Vec3 turned(const Vec3& arm, const Vec3& angle) {
  const double a = angle.norm();
  return a == 0.0 ? arm : Vec3(Eigen::AngleAxisd(a, angle / a) * arm);
}

}  // namespace

Particles::Particles(const Units& units, const Scene& scene, const Decomposition& ranks,
                     SolidTerm solid_term)
    : units_(units),
      hydraulic_ratio_(scene.particles->hydraulic_ratio),
      ranks_(ranks),
      flat_(ranks.domain().dimension() == 2),
      correction_(units, scene, solid_term, flat_),
      clump_shapes_(flat_, units.depth) {}

bool Particles::at_home(const protocol::Particle& particle) const {
  if (ranks_.alone()) return true;
  const Vec3 centre = units_.to_lattice_position(to_vec3(particle.state.x));
  return holds(ranks_.domain(), ranks_.cells(), centre);
}

double Particles::covered_radius(const protocol::Shape& shape) const {
  const auto type = static_cast<std::size_t>(std::max<std::int64_t>(1, shape.type));
  return shape.radius * hydraulic_ratio_[std::min(type, hydraulic_ratio_.size()) - 1];
}

std::vector<Past> Particles::present() const {
  const auto& sent = whole_.empty() ? loads_ : whole_;
  std::vector<Past> all;
  all.reserve(carriers_.size());
  for (const Carrier& carrier : carriers_) {
    const auto& [s, shape] = particles_[carrier.particle];
    const bool known = carrier.particle < sent.size();
    const protocol::Load load = known ? sent[carrier.particle] : protocol::Load{};
    all.push_back(
        {s.id, shape.epoch, {s.v, s.omega}, load.force, load.torque, carrier.mean_change});
  }
  return all;
}

void Particles::arrive(std::span<const protocol::Particle> particles, double interval) {
  past_ = present();
  interval_ = interval;
  particles_.assign(particles.begin(), particles.end());
  find_carriers();
  find_inner_fluid();
  find_past();
  loads_before_.swap(loads_);
  whole_before_ = std::exchange(whole_now_, false);
  loads_known_ = false;
  loads_.clear();
  whole_.clear();
}

void Particles::find_carriers() {
  carriers_.clear();
  spheres_.clear();
  carrier_of_.assign(particles_.size(), kNone);
  std::unordered_map<std::int64_t, std::size_t> clumps;  // [id of a carrier] its place
  for (const auto& p : particles_)
    if (protocol::is_part(p.shape)) clumps.emplace(p.shape.carrier, kNone);
  has_clumps_ = !clumps.empty();
  for (std::size_t i = 0; i < particles_.size(); ++i) {
    if (protocol::is_part(particles_[i].shape)) continue;
    if (const auto clump = clumps.find(particles_[i].state.id); clump != clumps.end())
      clump->second = carriers_.size();
    carrier_of_[i] = carriers_.size();
    carriers_.push_back({.particle = i, .home = at_home(particles_[i])});
  }
  for (std::size_t i = 0; i < particles_.size(); ++i) {
    const protocol::Shape& shape = particles_[i].shape;
    if (protocol::is_part(shape))
      add_sphere(i, clumps.at(shape.carrier));
    else if (!has_clumps_ || !clumps.contains(shape.id))
      spheres_.push_back({i, carrier_of_[i], covered_radius(shape), {}});
  }
}

/// A sphere of a clump, at the periodic image that is nearest to its carrier.
void Particles::add_sphere(std::size_t particle, std::size_t carrier) {
  const auto& [s, shape] = particles_[particle];
  Vec3 arm = to_vec3(s.x) - to_vec3(particles_[carriers_[carrier].particle].state.x);
  const Domain& domain = ranks_.domain();
  for (int k = 0; k < domain.dimension(); ++k) {
    const double length = domain.cells()[k] * units_.dx;
    if (domain.sides()[k] == Side::Periodic) arm[k] -= length * std::round(arm[k] / length);
  }
  if (flat_) arm.z() = 0.0;
  spheres_.push_back({particle, carrier, covered_radius(shape), arm});
}

void Particles::find_inner_fluid() {
  for (const Sphere& sphere : spheres_) {
    const auto& shape = particles_[sphere.particle].shape;
    carriers_[sphere.carrier].inside = correction_.ball(shape.radius, sphere.radius);
  }
  if (!has_clumps_) return;
  std::vector<std::vector<Sphere>> of(carriers_.size());
  for (const Sphere& sphere : spheres_) of[sphere.carrier].push_back(sphere);
  for (std::size_t c = 0; c < carriers_.size(); ++c) {
    if (of[c].size() == 1 && of[c].front().arm == Vec3()) continue;
    const protocol::Shape& clump = particles_[carriers_[c].particle].shape;
    const auto [volume, shape] = clump_shapes_.place(clump, of[c]);
    const double gyration2 =
        flat_ ? shape.inertia_per_mass(2, 2) : shape.inertia_per_mass.trace() / 3.0;
    carriers_[c].inside = {correction_.fluid_mass(volume), correction_.fluid_mass(clump.volume),
                           gyration2, shape};
  }
  clump_shapes_.keep_placed();
}

void Particles::find_past() {
  std::unordered_map<std::int64_t, const Past*> by_id;  // only where the order has changed
  const auto past_of = [&](std::size_t c, std::int64_t id) -> const Past* {
    if (c < past_.size() && past_[c].id == id) return &past_[c];
    if (by_id.empty())
      for (const Past& p : past_) by_id.emplace(p.id, &p);
    const auto found = by_id.find(id);
    return found == by_id.end() ? nullptr : found->second;
  };
  for (std::size_t c = 0; c < carriers_.size(); ++c) {
    Carrier& carrier = carriers_[c];
    const auto& [s, shape] = particles_[carrier.particle];
    carrier.past = past_of(c, s.id);
    if (carrier.past && carrier.past->epoch != shape.epoch) carrier.past = nullptr;
    if (carrier.past) correction_.note_change({s.v, s.omega}, carrier);
  }
}

std::int64_t Particles::carriers_at_home() const {
  return std::ranges::count_if(carriers_, &Carrier::home);
}

Vec3 Particles::weight_in_fluid() const {
  double mass = 0.0;
  for (const Carrier& carrier : carriers_) {
    if (!carrier.home) continue;
    mass += particles_[carrier.particle].shape.mass;
    if (correction_.lifts()) mass -= carrier.inside.displaced;
  }
  return mass * correction_.gravity();
}

std::vector<double> Particles::masses() const {
  std::vector<double> masses;
  for (const Sphere& sphere : spheres_) {
    const protocol::Shape& body = particles_[carriers_[sphere.carrier].particle].shape;
    const double turn = body.mass * sphere.arm.squaredNorm() / body.inertia;
    masses.push_back(body.mass / units_.mass() / (1.0 + turn));
  }
  return masses;
}

std::span<const Body> Particles::bodies(double elapsed) {
  bodies_.resize(spheres_.size());
  arms_.assign(has_clumps_ ? spheres_.size() : 0, Vec3());
  for (std::size_t j = 0; j < spheres_.size(); ++j) {
    const Sphere& sphere = spheres_[j];
    const protocol::State& s = particles_[carriers_[sphere.carrier].particle].state;
    Vec3 velocity = to_vec3(s.v), centre = to_vec3(s.x) + elapsed * velocity;
    if (sphere.arm != Vec3()) {
      const Vec3 spin = flat_ ? Vec3(0.0, 0.0, s.omega[2]) : to_vec3(s.omega);
      const Vec3 arm = turned(sphere.arm, elapsed * spin);
      centre += arm;
      velocity += spin.cross(arm);
      arms_[j] = arm / units_.dx;
    }
    Body& b = bodies_[j];
    b = {body_id(particles_[sphere.particle]), units_.to_lattice_position(centre),
         sphere.radius / units_.dx, units_.to_lattice_velocity(velocity),
         units_.to_lattice_spin(to_vec3(s.omega))};
    if (sphere.particle != carriers_[sphere.carrier].particle)
      b.carrier = static_cast<std::int32_t>(sphere.carrier) + 1;
    if (!flat_) continue;
    b.centre.z() = b.velocity.z() = 0.0;
    b.spin = b.spin.z();
  }
  return bodies_;
}

void Particles::add(std::span<const BodyLoad> loads) {
  for (std::size_t j = 0; j < loads.size(); ++j) {
    BodyLoad& sum = carriers_[spheres_[j].carrier].sum;
    sum.force += loads[j].force;
    sum.torque += loads[j].torque;
    if (has_clumps_ && arms_[j] != Vec3()) sum.torque += arms_[j].cross(loads[j].force);
  }
}

protocol::Load Particles::mean_load(const Carrier& carrier, int steps) const {
  const protocol::Particle& p = particles_[carrier.particle];
  const Vec3 force = carrier.sum.force * (units_.force() / steps);
  const Vec3 torque = carrier.sum.torque * (units_.torque() / steps);
  protocol::Load load{
      p.state.id, {force.x(), force.y(), force.z()}, {torque.x(), torque.y(), torque.z()}};
  if (carrier.home) correction_.add_known(p, carrier, interval_, load);
  correction_.add_virtual_mass(p, carrier, interval_, load);
  return load;
}

std::span<const protocol::Load> Particles::mean_loads(int steps) {
  loads_known_ = true;
  loads_.resize(particles_.size());
  for (std::size_t i = 0; i < particles_.size(); ++i)
    loads_[i] = carrier_of_[i] == kNone ? protocol::Load{particles_[i].state.id, {}, {}}
                                        : mean_load(carriers_[carrier_of_[i]], steps);
  if (correction_.any_light() && !ranks_.alone()) share_loads();
  return loads_;
}

/// The next interval's virtual mass needs the whole load of this one, and the home's mean change.
void Particles::share_loads() {
  std::vector<LightLine> mine;
  for (const Carrier& carrier : carriers_) {
    const protocol::Load& load = loads_[carrier.particle];
    mine.push_back({load.id, carrier.home, load.force, load.torque, carrier.mean_change});
  }
  const std::vector<LightLine> whole = share_light(ranks_, mine);
  whole_ = loads_;
  for (std::size_t c = 0; c < carriers_.size(); ++c) {
    whole_[carriers_[c].particle] = {whole[c].id, whole[c].force, whole[c].torque};
    carriers_[c].mean_change = whole[c].mean_change;
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
    const bool here = found != at.end();
    if (whole_before_ && (!here || !at_home(particles_[found->second]))) continue;
    if (!here)
      latest.push_back(load);
    else if (const std::size_t c = carrier_of_[found->second]; c != kNone && carriers_[c].past)
      latest[found->second] = load;  // else of the one that had its id before
  }
  return latest;
}

Particles::Everything Particles::gather() const {
  std::vector<protocol::Load> loads = latest_loads();
  if (ranks_.alone()) {
    loads.resize(size());
    return {particles_, std::move(loads)};
  }
  std::vector<ParticleLine> lines;
  for (std::size_t i = 0; i < loads.size(); ++i) {
    ParticleLine line{{}, 0, loads[i]};
    if (i < size() && at_home(particles_[i])) line = {particles_[i], 1, loads[i]};
    lines.push_back(line);
  }
  return gather_particles(ranks_, lines);
}

Record Particles::save() const {
  std::vector<Past> mine = present();
  const Everything whole = gather();  // of the loads every rank has a part
  std::size_t kept = 0;
  for (std::size_t c = 0; c < carriers_.size(); ++c)
    if (carriers_[c].home) mine[kept++] = mine[c];
  mine.resize(kept);
  const bool known = !whole_.empty();
  return save_past(ranks_, mine, known ? std::span<const protocol::Load>() : whole.loads);
}

void Particles::load(const Record& record) {
  particles_.clear();
  carriers_.clear();
  loads_.clear();
  whole_now_ = !ranks_.alone();
  for (const Past& past : load_past(record)) {
    protocol::Particle p;
    p.state.id = past.id;
    p.state.v = past.motion.v;
    p.state.omega = past.motion.omega;
    p.shape.epoch = past.epoch;
    Carrier& carrier = carriers_.emplace_back();
    carrier.particle = particles_.size();
    carrier.home = at_home(p);  // of all ranks one
    carrier.mean_change = past.mean_change;
    particles_.push_back(p);
    loads_.push_back({past.id, past.force, past.torque});
  }
}

double Particles::max_speed() const {
  double largest = 0.0;
  for (const Carrier& carrier : carriers_) {
    const auto& [s, shape] = particles_[carrier.particle];
    largest = std::max(largest, to_vec3(s.v).norm() + to_vec3(s.omega).norm() * shape.radius);
  }
  return largest;
}

}  // namespace lbm
