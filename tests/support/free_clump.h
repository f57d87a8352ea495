// SPDX-License-Identifier: GPL-2.0-or-later
/// A rigid body of discs or spheres that a solid program would integrate, as it is on the wire.
#pragma once

#include <Eigen/Geometry>
#include <cmath>
#include <vector>

#include "lbm_solver/coupling/particles.h"
#include "lbm_solver/solver/fluid.h"
#include "protocol/wire/ball_union.h"

namespace test {

using namespace lbm;

/// In lattice units: cells, steps, density of the fluid 1. Its frame is that of the spheres as they
/// are given, about the centre of their union.
class FreeClump {
 public:
  struct Part {
    Vec3 at;
    double radius = 0.0;
  };
  /// @param density  over the fluid's
  FreeClump(std::vector<Part> parts, double density, const Vec3& place, int dimension)
      : dimension_(dimension), parts_(std::move(parts)), place_(place) {
    std::vector<protocol::Ball> balls;
    for (const Part& p : parts_) balls.push_back({0, {p.at.x(), p.at.y(), p.at.z()}, p.radius});
    const auto first = protocol::moments_of_union(balls, dimension);
    for (std::size_t i = 0; i < parts_.size(); ++i) {
      for (int k = 0; k < 3; ++k) balls[i].x[k] -= first.centroid[k];
      parts_[i].at = to_vec3(balls[i].x);
    }
    const auto m = protocol::moments_of_union(balls, dimension);
    volume_ = m.volume;
    mass_ = density * volume_;
    radius_ = protocol::bounding_radius(balls);
    const auto& [xx, yy, zz, yz, zx, xy] = m.second;
    Eigen::Matrix3d second;
    second << xx, xy, zx, xy, yy, yz, zx, yz, zz;
    inertia_ = mass_ * (second.trace() * Eigen::Matrix3d::Identity() - second);
  }

  /// Carrier 1 and its spheres from 2 on, as a solid tells them.
  std::vector<protocol::Particle> particles() const {
    const auto wire = [](const Vec3& v) { return protocol::Vec3{v.x(), v.y(), v.z()}; };
    const double mean = dimension_ == 2 ? inertia_(2, 2) : inertia_.trace() / 3.0;
    std::vector<protocol::Particle> all{{{1, wire(place_), wire(velocity), wire(spin())},
                                         {1, radius_, mass_, mean, 1, 0, -1, volume_}}};
    for (const Part& p : parts_) {
      const Vec3 arm = turn_ * p.at;
      const auto id = static_cast<std::int64_t>(all.size()) + 1;
      all.push_back({{id, wire(place_ + arm), wire(velocity + spin().cross(arm)), wire(spin())},
                     {id, p.radius, 0.0, 0.0, 1, 0, 1, 0.0}});
    }
    return all;
  }

  /// Its motion under a force and a torque of an interval.
  void move(const Vec3& force, const Vec3& torque, double interval) {
    velocity += interval * force / mass_;
    place_ += interval * velocity;
    momentum_ += interval * torque;
    const Vec3 angle = interval * spin();
    if (angle.norm() > 0.0)
      turn_ = (Eigen::AngleAxisd(angle.norm(), angle.normalized()) * turn_).normalized();
  }
  /// One coupling interval of a single fluid step.
  protocol::Load step(Particles& wire, Fluid& fluid, const Vec3& gravity = Vec3()) {
    wire.arrive(particles(), 1.0);
    fluid.place(wire.bodies(0.0));
    fluid.step();
    wire.add(fluid.loads());
    const protocol::Load load = wire.mean_loads(1)[0];
    move(to_vec3(load.force) + mass_ * gravity, to_vec3(load.torque), 1.0);
    return load;
  }

  Vec3 spin() const {
    const Eigen::Matrix3d r = turn_.toRotationMatrix();
    if (dimension_ == 2) return {0.0, 0.0, momentum_.z() / inertia_(2, 2)};
    return Vec3(r * inertia_.inverse() * r.transpose() * momentum_);
  }
  void set_spin(const Vec3& spin) {
    const Eigen::Matrix3d r = turn_.toRotationMatrix();
    momentum_ = dimension_ == 2 ? Vec3(0.0, 0.0, inertia_(2, 2) * spin.z())
                                : Vec3(r * inertia_ * r.transpose() * spin);
  }
  void turn(const Eigen::AngleAxisd& by) { turn_ = by * turn_; }
  const Vec3& place() const { return place_; }
  /// Where an axis of its frame points.
  Vec3 axis(const Vec3& own) const { return turn_ * own; }
  double mass() const { return mass_; }
  double volume() const { return volume_; }

  Vec3 velocity;

 private:
  int dimension_;
  std::vector<Part> parts_;
  double volume_ = 0.0, mass_ = 0.0, radius_ = 0.0;
  Eigen::Matrix3d inertia_;
  Vec3 place_, momentum_;  // angular momentum
  Eigen::Quaterniond turn_ = Eigen::Quaterniond::Identity();
};

/// The coupling of a clump in lattice units.
inline Particles clump_coupling(const Fluid& fluid, SolidTerm solid_term, double virtual_mass = 0.0,
                                const Vec3& gravity = Vec3()) {
  Scene scene;
  scene.fluid.density = 1.0;
  scene.fluid.gravity = gravity;
  scene.coupling.emplace();
  scene.coupling->virtual_mass = virtual_mass;
  scene.particles.emplace();
  scene.particles->density = {1.0, 1.0};
  return {Units{}, scene, fluid.domain(), solid_term};
}

}  // namespace test
