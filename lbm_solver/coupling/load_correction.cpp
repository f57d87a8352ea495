// SPDX-License-Identifier: GPL-2.0-or-later
#include "lbm_solver/coupling/load_correction.h"

#include <cmath>
#include <numbers>

#include "lbm_solver/immersed/solid_term.h"

namespace lbm {
namespace {

double relaxation_time(const Units& units, const FluidScene& fluid) {
  return 0.5 + 3.0 * fluid.viscosity * units.dt / (units.dx * units.dx);
}

}  // namespace

LightRule light_rule(SolidTerm solid_term, double tau) {
  if (by_resistance(solid_term)) return {tau < 0.525 ? 1.5 : 0.99, 1.0, 0.05};
  return {tau > 0.8 ? 2.0 : 0.9, 2.0, 0.2};
}

LoadCorrection::LoadCorrection(const Units& units, const Scene& scene, SolidTerm solid_term,
                               bool flat)
    : fluid_(scene.fluid),
      coupling_(*scene.coupling),
      depth_(units.depth),
      light_(light_rule(solid_term, relaxation_time(units, scene.fluid))),
      flat_(flat),
      any_light_(coupling_.virtual_mass
                     ? *coupling_.virtual_mass > 0.0
                     : scene.particles->density.lo < light_.ratio * fluid_.density) {}

/// Fluid in a disc or sphere [kg].
double LoadCorrection::in_ball(double radius) const {
  return fluid_.density * std::numbers::pi * radius * radius *
         (flat_ ? depth_ : 4.0 / 3.0 * radius);
}

DisplacedFluid LoadCorrection::ball(double radius, double covered_radius) const {
  const double r = covered_radius;
  return {in_ball(r), in_ball(radius), (flat_ ? 0.5 : 0.4) * r * r, {}};
}

void LoadCorrection::note_change(const Velocities& now, Carrier& carrier) const {
  const auto note = [this](const protocol::Vec3& now, const protocol::Vec3& past,
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
  const Past& past = *carrier.past;
  note(now.v, past.motion.v, past.mean_change.v, carrier.change.v, carrier.mean_change.v);
  note(now.omega, past.motion.omega, past.mean_change.omega, carrier.change.omega,
       carrier.mean_change.omega);
}

/// Over the covered mass.
double LoadCorrection::virtual_mass(const protocol::Particle& p, const Carrier& carrier) const {
  if (!any_light_) return 0.0;
  if (coupling_.virtual_mass) return *coupling_.virtual_mass;
  return p.shape.mass < light_.ratio * carrier.inside.covered ? light_.virtual_mass : 0.0;
}

void LoadCorrection::add_inner_fluid(const protocol::Particle& p, const Carrier& carrier,
                                     double interval, protocol::Load& load) const {
  const DisplacedFluid& inside = carrier.inside;
  const Velocities& change = virtual_mass(p, carrier) > 0.0 ? carrier.mean_change : carrier.change;
  const double mass = inside.covered, inertia = mass * inside.gyration2;
  for (int k = 0; k < (flat_ ? 2 : 3); ++k) load.force[k] += mass * change.v[k] / interval;
  if (inside.uneven) return add_uneven(to_vec3(p.state.omega), inside, change, interval, load);
  for (int k = flat_ ? 2 : 0; k < 3; ++k) load.torque[k] += inertia * change.omega[k] / interval;
}

/// Of a clump all that is not m_c dU/dt.
void LoadCorrection::add_uneven(const Vec3& omega, const DisplacedFluid& inside,
                                const Velocities& change, double interval,
                                protocol::Load& load) const {
  const Vec3 spin = flat_ ? Vec3(0.0, 0.0, omega.z()) : omega;
  Vec3 spin_up = to_vec3(change.omega) / interval, speed_up = to_vec3(change.v) / interval;
  if (flat_) {
    spin_up.x() = spin_up.y() = speed_up.z() = 0.0;
  }
  const Vec3& d = inside.uneven->centroid;
  const Eigen::Matrix3d& j = inside.uneven->inertia_per_mass;
  const Vec3 off = spin_up.cross(d) + spin.cross(spin.cross(d));
  const Vec3 turn = d.cross(speed_up) + j * spin_up + spin.cross(j * spin);
  for (int k = 0; k < (flat_ ? 2 : 3); ++k) load.force[k] += inside.covered * off[k];
  for (int k = flat_ ? 2 : 0; k < 3; ++k) load.torque[k] += inside.covered * turn[k];
}

void LoadCorrection::add_known(const protocol::Particle& p, const Carrier& carrier, double interval,
                               protocol::Load& load) const {
  if (coupling_.inner_inertia) add_inner_fluid(p, carrier, interval, load);
  if (coupling_.buoyancy != protocol::Buoyancy::ByFluid) return;
  const double displaced = carrier.inside.displaced;
  for (int k = 0; k < (flat_ ? 2 : 3); ++k) load.force[k] -= displaced * fluid_.gravity[k];
  if (!carrier.inside.uneven) return;
  const Vec3 turn = carrier.inside.uneven->centroid.cross(-displaced * fluid_.gravity);
  for (int k = flat_ ? 2 : 0; k < 3; ++k) load.torque[k] += turn[k];
}

void LoadCorrection::add_virtual_mass(const protocol::Particle& p, const Carrier& carrier,
                                      double interval, protocol::Load& load) const {
  const protocol::Shape& shape = p.shape;
  const double mass = virtual_mass(p, carrier) * carrier.inside.covered;
  if (mass == 0.0) return;
  const auto blend = [home = carrier.home](double load, double acceleration, double others,
                                           double own, double extra) {
    const double known = home ? own * extra * acceleration - extra * others : 0.0;
    return (own * load + known) / (own + extra);
  };
  const Past* past = carrier.past;
  for (int k = 0; k < (flat_ ? 2 : 3); ++k) {
    const double acceleration = carrier.change.v[k] / interval;
    const double others =
        past ? shape.mass * acceleration - past->force[k] : shape.mass * fluid_.gravity[k];
    load.force[k] = blend(load.force[k], acceleration, others, shape.mass, mass);
  }
  // Of a clump both inertias are the same tensor but for a factor: it is taken to the acceleration.
  const double gyration2 = carrier.inside.gyration2;
  protocol::Vec3 change = carrier.change.omega;
  if (const auto& uneven = carrier.inside.uneven) {
    const Vec3 turned = uneven->inertia_per_mass * to_vec3(change) / gyration2;
    change = {turned.x(), turned.y(), turned.z()};
  }
  for (int k = flat_ ? 2 : 0; k < 3; ++k) {
    const double spin_up = change[k] / interval;
    const double others = past ? shape.inertia * spin_up - past->torque[k] : 0.0;
    load.torque[k] = blend(load.torque[k], spin_up, others, shape.inertia, mass * gyration2);
  }
}

}  // namespace lbm
