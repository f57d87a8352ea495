// SPDX-License-Identifier: GPL-2.0-or-later
#include "lbm_solver/coupling/particles.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace {

using namespace lbm;

const Units kUnits{1e-4, 2e-4, 1000.0, 0.5, {0.0, 0.0}};
constexpr double kRadius = 1e-3;
const double kFluidMass = 1000.0 * std::numbers::pi * kRadius * kRadius * 0.5;

FluidScene fluid_scene() {
  return {.density = 1000.0, .viscosity = 1e-5, .gravity = {0.0, -9.8}, .velocity_scale = 0.05};
}

Scene scene_of(const CouplingScene& coupling) {
  Scene scene;
  scene.fluid = fluid_scene();
  scene.coupling = coupling;
  if (!coupling.virtual_mass) scene.coupling->virtual_mass = 0.0;
  scene.particles.emplace();
  return scene;
}

protocol::Particle particle(double vx, double omega) {
  return {{9, {0.005, 0.01, 0.0}, {vx, 0.0, 0.0}, {0.0, 0.0, omega}}, {9, kRadius, 4e-3, 2e-9, 1}};
}

const Domain kDomain{100, 100};

TEST(Particles, EntersLatticeUnits) {
  Particles particles(kUnits, scene_of({}), kDomain, SolidTerm::LayeredHoldych);
  particles.arrive(std::vector{particle(0.02, 30.0)}, 4e-4);
  const auto bodies = particles.bodies(2e-4);
  EXPECT_NEAR(bodies[0].centre.x(), 50.0 + 0.02 * 2e-4 / 1e-4, 1e-12);  // moved on straight
  EXPECT_NEAR(bodies[0].radius, 10.0, 1e-12);
  EXPECT_NEAR(bodies[0].velocity.x(), 0.02 / 0.5, 1e-15);
  EXPECT_NEAR(bodies[0].spin.z(), 30.0 * 2e-4, 1e-15);
  EXPECT_NEAR(particles.max_speed(), 0.02 + 30.0 * kRadius, 1e-15);
}

TEST(Particles, LoadIsTheMeanInSiUnitsWithBuoyancy) {
  Particles particles(kUnits, scene_of({}), kDomain, SolidTerm::LayeredHoldych);
  particles.arrive(std::vector{particle(0.0, 0.0)}, 4e-4);
  particles.add(std::vector<BodyLoad>{{{2.0, 0.0}, {0.0, 0.0, 4.0}}});
  particles.add(std::vector<BodyLoad>{{{4.0, 0.0}, {0.0, 0.0, 0.0}}});
  const auto load = particles.mean_loads(2)[0];
  // one lattice unit of force: rho dx^3 depth / dt^2 (2D, a layer of thickness depth)
  const double force = 1000.0 * 1e-12 * 0.5 / (2e-4 * 2e-4);
  EXPECT_EQ(load.id, 9);
  EXPECT_NEAR(load.force[0], 3.0 * force, 1e-12 * force);
  EXPECT_NEAR(load.force[1], kFluidMass * 9.8, 1e-12);
  EXPECT_NEAR(load.torque[2], 2.0 * force * 1e-4, 1e-15);
}

TEST(Particles, GivesBackTheInertiaOfTheFluidInside) {
  CouplingScene coupling;
  coupling.buoyancy = protocol::Buoyancy::None;
  for (const bool on : {true, false}) {
    coupling.inner_inertia = on;
    Particles particles(kUnits, scene_of(coupling), kDomain, SolidTerm::LayeredHoldych);
    particles.arrive(std::vector{particle(0.02, 30.0)}, 4e-4);
    particles.add(std::vector<BodyLoad>(1));
    EXPECT_EQ(particles.mean_loads(1)[0].force[0], 0.0);  // new: its past is unknown
    particles.arrive(std::vector{particle(0.03, 32.0)}, 4e-4);
    particles.add(std::vector<BodyLoad>(1));
    const auto load = particles.mean_loads(1)[0];
    EXPECT_NEAR(load.force[0], on ? kFluidMass * 0.01 / 4e-4 : 0.0, 1e-12);
    EXPECT_NEAR(load.torque[2], on ? 0.5 * kFluidMass * kRadius * kRadius * 2.0 / 4e-4 : 0.0,
                1e-15);
  }
}

TEST(Particles, AParticleThatLeftAndCameBackHasNoPast) {
  CouplingScene coupling;
  coupling.buoyancy = protocol::Buoyancy::None;
  Particles particles(kUnits, scene_of(coupling), kDomain, SolidTerm::LayeredHoldych);
  particles.arrive(std::vector{particle(0.02, 0.0)}, 4e-4);
  particles.arrive({}, 4e-4);
  EXPECT_EQ(particles.bodies(0.0).size(), 0U);
  EXPECT_EQ(particles.mean_loads(1).size(), 0U);
  particles.arrive(std::vector{particle(0.05, 0.0)}, 4e-4);
  particles.add(std::vector<BodyLoad>(1));
  EXPECT_EQ(particles.mean_loads(1)[0].force[0], 0.0);
}

// Another particle with the same id: no velocity, load or body of the one before, also not after a
// restart in between.
TEST(Particles, AnIdOfAnotherEpochStartsAnew) {
  CouplingScene coupling;
  coupling.buoyancy = protocol::Buoyancy::None;
  protocol::Particle other = particle(0.05, 0.0);
  other.shape.epoch = 7;
  for (const bool restart : {false, true}) {
    Particles first(kUnits, scene_of(coupling), kDomain, SolidTerm::LayeredHoldych), second = first;
    first.arrive(std::vector{particle(0.02, 0.0)}, 4e-4);
    const std::int64_t body = first.bodies(0.0)[0].id;
    first.add(std::vector<BodyLoad>{{{2.0, 0.0}, {0.0, 0.0, 4.0}}});
    first.mean_loads(1);
    if (restart) second.load(first.save());
    Particles& particles = restart ? second : first;
    particles.arrive(std::vector{other}, 4e-4);
    EXPECT_NE(particles.bodies(0.0)[0].id, body);
    EXPECT_EQ(particles.gather().loads[0].force[0], 0.0);
    particles.add(std::vector<BodyLoad>(1));
    EXPECT_EQ(particles.mean_loads(1)[0].force[0], 0.0);
    other.state.v[0] += 0.01;  // the same one now: it has a past
    particles.arrive(std::vector{other}, 4e-4);
    particles.add(std::vector<BodyLoad>(1));
    EXPECT_NEAR(particles.mean_loads(1)[0].force[0], kFluidMass * 0.01 / 4e-4, 1e-12);
    other.state.v[0] -= 0.01;
  }
}

TEST(Particles, VirtualMassLeavesASteadyLoadAsItIs) {
  // Held by another force that balances the load: nothing accelerates, so nothing may change.
  CouplingScene coupling;
  coupling.buoyancy = protocol::Buoyancy::None;
  coupling.virtual_mass = 2.0;
  Particles particles(kUnits, scene_of(coupling), kDomain, SolidTerm::LayeredHoldych);
  protocol::Load load;
  for (int k = 0; k < 60; ++k) {
    particles.arrive(std::vector{particle(0.02, 30.0)}, 4e-4);
    particles.add(std::vector<BodyLoad>{{{2.0, 0.0}, {0.0, 0.0, 4.0}}});
    load = particles.mean_loads(1)[0];
  }
  const double force = 1000.0 * 1e-12 * 0.5 / (2e-4 * 2e-4);
  EXPECT_NEAR(load.force[0], 2.0 * force, 1e-9 * force);
  EXPECT_NEAR(load.torque[2], 4.0 * force * 1e-4, 1e-9 * force * 1e-4);
}

TEST(Particles, TheFluidSeesTheHydraulicRadius) {
  Scene scene = scene_of({});
  scene.particles->hydraulic_ratio = {1.0, 0.8};
  Particles particles(kUnits, scene, kDomain, SolidTerm::LayeredHoldych);
  protocol::Particle small = particle(0.0, 0.0);
  small.shape.type = 2;
  particles.arrive(std::vector{small}, 4e-4);
  EXPECT_NEAR(particles.bodies(0.0)[0].radius, 8.0, 1e-12);
}

TEST(Particles, BuoyancyIsThatOfTheWholeParticleForEveryHydraulicRatio) {
  // The lattice carries no hydrostatic pressure, so the upthrust is all in this term: rho_f V g
  // with the particle's own volume. Sums of a few products: 1e-12 of the value is round-off.
  for (const double ratio : {1.0, 0.8, 0.5}) {
    Scene scene = scene_of({});
    scene.particles->hydraulic_ratio = {ratio};
    Particles disc(kUnits, scene, kDomain, SolidTerm::LayeredHoldych);
    disc.arrive(std::vector{particle(0.0, 0.0)}, 4e-4);
    disc.add(std::vector<BodyLoad>(1));
    const double of_disc = kFluidMass * 9.8;
    EXPECT_NEAR(disc.mean_loads(1)[0].force[1], of_disc, 1e-12 * of_disc) << "ratio " << ratio;

    Domain cube{100, 100};
    cube.nz = 100;
    Particles sphere(kUnits, scene, cube, SolidTerm::LayeredHoldych);
    protocol::Particle p = particle(0.0, 0.0);
    p.state.x[2] = 0.005;
    sphere.arrive(std::vector{p}, 4e-4);
    sphere.add(std::vector<BodyLoad>(1));
    const double of_sphere = 4.0 / 3.0 * std::numbers::pi * std::pow(kRadius, 3) * 1000.0 * 9.8;
    EXPECT_NEAR(sphere.mean_loads(1)[0].force[1], of_sphere, 1e-12 * of_sphere)
        << "ratio " << ratio;
  }
}

TEST(Particles, InnerFluidIsThatOfTheCoveredCells) {
  // The lattice's force has the momentum of the fluid in covered cells in it, no more: what is
  // given back goes with ratio² (mass) and ratio⁴ (moment of inertia) of a disc.
  CouplingScene coupling;
  coupling.buoyancy = protocol::Buoyancy::None;
  Scene scene = scene_of(coupling);
  scene.particles->hydraulic_ratio = {0.8};
  Particles particles(kUnits, scene, kDomain, SolidTerm::LayeredHoldych);
  particles.arrive(std::vector{particle(0.02, 30.0)}, 4e-4);
  particles.add(std::vector<BodyLoad>(1));
  particles.mean_loads(1);
  particles.arrive(std::vector{particle(0.03, 32.0)}, 4e-4);
  particles.add(std::vector<BodyLoad>(1));
  const auto load = particles.mean_loads(1)[0];
  const double force = 0.64 * kFluidMass * 0.01 / 4e-4;
  const double torque = 0.4096 * 0.5 * kFluidMass * kRadius * kRadius * 2.0 / 4e-4;
  EXPECT_NEAR(load.force[0], force, 1e-12 * force);
  EXPECT_NEAR(load.torque[2], torque, 1e-12 * torque);
}

}  // namespace
