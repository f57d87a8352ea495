// SPDX-License-Identifier: GPL-2.0-or-later
/// A clump between wire and lattice, without a fluid: where its spheres go, what its load is.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "lbm_solver/coupling/clump_shapes.h"
#include "lbm_solver/coupling/lubrication.h"
#include "lbm_solver/coupling/particles.h"
#include "lbm_solver/immersed/cover_map.h"
#include "protocol/wire/ball_union.h"

namespace {

using namespace lbm;
using std::numbers::pi;

constexpr double kVolume = 400.0;

Scene scene(const Vec3& gravity = Vec3()) {
  Scene s;
  s.fluid.density = 1.0;
  s.fluid.gravity = gravity;
  s.coupling.emplace();
  s.coupling->virtual_mass = 0.0;
  s.particles.emplace();
  s.particles->density = {1.0, 1.0};
  return s;
}

/// Carrier 1 at x = 11, with spheres 2 and 3 at arms ±2 along y; everything in lattice units.
std::vector<protocol::Particle> dumbbell(double mass = 600.0) {
  protocol::Particle carrier{{1, {11.0, 10.0, 9.0}, {}, {}},
                             {1, 6.0, mass, 12.0 * mass, 1, 0, -1, kVolume}};
  std::vector<protocol::Particle> all{carrier};
  for (const double arm : {2.0, -2.0}) {
    protocol::Particle p = carrier;
    p.state.id = p.shape.id = arm > 0 ? 2 : 3;
    p.state.x[1] += arm;
    p.shape = {p.state.id, 4.0, 0.0, 0.0, 1, 0, 1, 0.0};
    all.push_back(p);
  }
  return all;
}

constexpr Domain kBox{20, 20, Side::Periodic, Side::Periodic, 20, Side::Periodic};

TEST(ClumpOnTheLattice, SpheresTurnWithTheirCarrierDuringAnInterval) {
  Particles wire(Units{}, scene(), kBox, SolidTerm::LayeredResistance);
  auto all = dumbbell();
  all[0].state.v = {0.1, 0.0, 0.0};
  all[0].state.omega = {0.0, 0.0, 0.5 * pi / 4.0};  // a quarter turn in four steps
  wire.arrive(all, 4.0);
  const auto bodies = wire.bodies(4.0);
  ASSERT_EQ(bodies.size(), 2U);
  EXPECT_LT((bodies[0].centre - Vec3(11.4 - 2.0, 10.0, 9.0)).norm(), 1e-12);
  EXPECT_LT((bodies[1].centre - Vec3(11.4 + 2.0, 10.0, 9.0)).norm(), 1e-12);
  EXPECT_LT((bodies[0].velocity - Vec3(0.1, -0.25 * pi, 0.0)).norm(), 1e-12);
  EXPECT_EQ(bodies[0].carrier, bodies[1].carrier);
  EXPECT_NE(bodies[0].carrier, 0);
}

TEST(ClumpOnTheLattice, ASphereBeyondAPeriodicSideIsBroughtToItsCarrier) {
  Particles wire(Units{}, scene(), kBox, SolidTerm::LayeredResistance);
  auto all = dumbbell();
  all[0].state.x[1] = 19.5;
  all[1].state.x[1] = 1.5;  // an image of 21.5
  all[2].state.x[1] = 17.5;
  wire.arrive(all, 1.0);
  EXPECT_NEAR(wire.bodies(0.0)[0].centre.y(), 21.5, 1e-12);
  EXPECT_NEAR(wire.bodies(0.0)[1].centre.y(), 17.5, 1e-12);
}

TEST(ClumpOnTheLattice, LoadIsTheSumAboutTheCarriersCentreWithBuoyancyOfItsVolume) {
  Particles wire(Units{}, scene({0.0, 0.0, -0.01}), kBox, SolidTerm::LayeredResistance);
  wire.arrive(dumbbell(), 1.0);
  wire.bodies(0.0);
  wire.add(std::vector<BodyLoad>{{{1.0, 0.0, 2.0}, {0.3, 0.0, 0.0}}, {{3.0, 0.0, 5.0}, {}}});
  const auto loads = wire.mean_loads(1);
  ASSERT_EQ(loads.size(), 3U);
  EXPECT_NEAR(loads[0].force[0], 4.0, 1e-12);
  EXPECT_NEAR(loads[0].force[2], 7.0 + 0.01 * kVolume, 1e-12);
  EXPECT_NEAR(loads[0].torque[0], 0.3 + 2.0 * 2.0 - 2.0 * 5.0, 1e-12);  // y F_z
  EXPECT_NEAR(loads[0].torque[2], -2.0 * 1.0 + 2.0 * 3.0, 1e-12);       // -y F_x
  for (const int sphere : {1, 2}) {
    EXPECT_EQ(loads[sphere].id, sphere + 1);
    EXPECT_EQ(loads[sphere].force, protocol::Vec3());
    EXPECT_EQ(loads[sphere].torque, protocol::Vec3());
  }
}

TEST(ClumpOnTheLattice, GivesBackTheInertiaOfTheFluidInItsUnion) {
  const protocol::Ball balls[] = {{2, {0.0, 2.0, 0.0}, 4.0}, {3, {0.0, -2.0, 0.0}, 4.0}};
  const auto m = protocol::moments_of_union(balls, 3);
  Particles wire(Units{}, scene(), kBox, SolidTerm::LayeredResistance);
  auto all = dumbbell();
  all[0].state.omega = {0.02, 0.03, 0.0};
  wire.arrive(all, 2.0);
  wire.bodies(0.0);
  all[0].state.v = {0.0, 0.0, 0.06};
  all[0].state.omega = {0.02, 0.03, 0.05};
  wire.arrive(all, 2.0);
  wire.bodies(0.0);
  const protocol::Load load = wire.mean_loads(1)[0];
  const double jx = m.volume * (m.second[1] + m.second[2]),
               jy = m.volume * (m.second[0] + m.second[2]);
  // J dω/dt + ω × J ω; the quadrature is in the frame of the clump: 3e-5, of differences more
  EXPECT_NEAR(load.force[2] / (m.volume * 0.03), 1.0, 3e-5);
  EXPECT_NEAR(load.torque[2] / (jx * 0.025 + 0.02 * 0.03 * (jy - jx)), 1.0, 1e-4);
  EXPECT_NEAR(load.torque[0] / (0.03 * 0.05 * (jx - jy)), 1.0, 1e-4);
}

TEST(ClumpOnTheLattice, ItsShapeTurnsWithIt) {
  // Measured in one orientation, placed in another: as measured there.
  const std::vector<Vec3> arms{
      {2.0, 0.5, -0.3}, {-1.5, 1.0, 0.8}, {0.2, -1.7, 1.1}, {-0.4, 0.6, -1.9}};
  const std::vector<double> radii{2.5, 2.0, 1.8, 2.2};
  const Eigen::AngleAxisd by(1.1, Eigen::Vector3d(1.0, 2.0, -0.5).normalized());
  const auto spheres = [&](bool turned) {
    std::vector<Sphere> all;
    for (std::size_t i = 0; i < arms.size(); ++i)
      all.push_back({i, 0, radii[i], turned ? Vec3(by * arms[i]) : arms[i]});
    return all;
  };
  protocol::Shape clump;
  clump.id = 1;
  ClumpShapes kept(false, 1.0), fresh(false, 1.0);
  const auto before = kept.place(clump, spheres(false));
  const auto after = kept.place(clump, spheres(true)), anew = fresh.place(clump, spheres(true));
  EXPECT_EQ(after.volume, anew.volume);
  EXPECT_LT((after.shape.inertia_per_mass - anew.shape.inertia_per_mass).norm(), 1e-12);
  const Eigen::Matrix3d r = by.toRotationMatrix();
  EXPECT_LT(
      (after.shape.inertia_per_mass - r * before.shape.inertia_per_mass * r.transpose()).norm(),
      1e-12);
  EXPECT_GT((after.shape.inertia_per_mass - before.shape.inertia_per_mass).norm(), 0.1);
  EXPECT_GT(before.shape.centroid.norm(), 0.1);
  EXPECT_LT((after.shape.centroid - r * before.shape.centroid).norm(), 1e-12);
}

/// Σ of the fractions that bodies cover.
double covered(const std::vector<Body>& bodies, const Domain& domain) {
  CoverMap cover(domain);
  cover.update(bodies);
  double sum = 0.0;
  for (int z = 0; z < domain.nz; ++z)
    for (int y = 0; y < domain.ny; ++y)
      for (int x = 0; x < domain.nx; ++x) sum += cover.solid_fraction(x, y, z);
  return sum;
}

TEST(ClumpOnTheLattice, SpheresThatOverlapCoverTheirUnion) {
  for (const bool flat : {false, true}) {
    const Domain domain = flat ? Domain{32, 32, Side::Periodic, Side::Periodic}
                               : Domain{24, 24, Side::Periodic, Side::Periodic, 24, Side::Periodic};
    const Vec3 middle(12.3, 11.6, flat ? 0.0 : 12.2);
    const std::vector<Vec3> arms{{2.1, 0.7, flat ? 0.0 : 0.4},
                                 {-1.9, -0.3, flat ? 0.0 : 0.6},
                                 {0.3, 1.4, flat ? 0.0 : -1.2}};
    std::vector<Body> bodies;
    std::vector<protocol::Ball> balls;
    for (const Vec3& arm : arms) {
      Body& b = bodies.emplace_back();
      b.id = static_cast<std::int64_t>(bodies.size());
      b.carrier = 1;
      b.centre = middle + arm;
      b.radius = 4.0;
      balls.push_back({b.id, {arm.x(), arm.y(), arm.z()}, 4.0});
    }
    const double volume = protocol::moments_of_union(balls, flat ? 2 : 3).volume;
    // half a percent: what a single sphere of this size is wrong by (solid_fraction.h)
    EXPECT_NEAR(covered(bodies, domain) / volume, 1.0, 0.005) << flat;
    bodies.push_back(bodies[1]);  // the same once more
    EXPECT_NEAR(covered(bodies, domain) / volume, 1.0, 0.005) << flat;
  }
}

TEST(ClumpOnTheLattice, WhatItsSpheresCoverKnowsNoPast) {
  std::vector<Body> bodies(2);
  const auto place = [&](double angle) {
    for (int i = 0; i < 2; ++i) {
      bodies[i].id = i;
      bodies[i].carrier = 1;
      bodies[i].radius = 4.0;
      bodies[i].centre = Vec3(12.0, 12.0, 12.0);  // the first stays where it is
      if (i == 1) bodies[i].centre += 3.0 * Vec3(std::cos(angle), std::sin(angle), 0.2);
    }
  };
  const Domain domain{24, 24, Side::Periodic, Side::Periodic, 24, Side::Periodic};
  CoverMap used(domain), fresh(domain);
  for (const double angle : {0.3, 1.2, 2.9, 0.7}) {
    place(angle);
    used.update(bodies);
  }
  fresh.update(bodies);
  for (int z = 0; z < 24; ++z)
    for (int y = 0; y < 24; ++y)
      for (int x = 0; x < 24; ++x)
        ASSERT_EQ(used.cell(x, y, z).cover, fresh.cell(x, y, z).cover) << x << ' ' << y << ' ' << z;
}

TEST(ClumpOnTheLattice, ItsSpheresHaveNoLubricationBetweenThem) {
  std::vector<Body> bodies(2);
  bodies[0].centre = {8.0, 10.0, 10.0};
  bodies[1].centre = {14.1, 10.0, 10.0};
  for (Body& b : bodies) b.radius = 3.0;
  bodies[0].velocity = {0.1, 0.0, 0.0};
  const std::vector<double> masses{100.0, 100.0};
  for (const int carrier : {0, 1}) {
    for (Body& b : bodies) b.carrier = carrier;
    std::vector<BodyLoad> loads(2);
    Lubrication{.viscosity = 0.1, .range = 1.0}.add(bodies, masses, kBox, loads);
    EXPECT_EQ(loads[0].force.norm() > 0.0, carrier == 0);
  }
}

}  // namespace
