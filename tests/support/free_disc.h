// SPDX-License-Identifier: GPL-2.0-or-later
/// A disc, in three dimensions a sphere, that a solid program would integrate, coupled as the
/// programs are.
#pragma once

#include <functional>
#include <numbers>
#include <span>
#include <string>
#include <vector>

#include "lbm_solver/coupling/particles.h"
#include "lbm_solver/solver/fluid.h"

namespace test {

using namespace lbm;

/// In lattice units: cells, steps, density of the fluid 1.
struct FreeDisc {
  double ratio = 1.0;   ///< of its density
  double radius = 5.0;  ///< [cells]
  Vec3 start;
  int inserted = 0;  ///< step before which it is not there
  int steps = 0;
  int fluid_steps = 1;                                  ///< a coupling interval
  SolidTerm solid_term = SolidTerm::LayeredResistance;  ///< of the fluid's kernel
  std::function<void()> seen = [] {};                   ///< called after each interval
};

/// Of each interval in which the disc was there: place and velocity at its end, mean force.
struct FreeRun {
  std::vector<Vec3> place, velocity;
  std::vector<double> force_y;
};

inline FreeRun free_run(Fluid& fluid, const Scene& scene, const FreeDisc& disc) {
  Particles particles({1.0, 1.0, 1.0, 1.0, {0.0, 0.0}}, scene, fluid.domain(), disc.solid_term);
  const int dimension = fluid.domain().dimension();
  const double r2 = disc.radius * disc.radius, interval = disc.fluid_steps;
  const double volume = std::numbers::pi * r2 * (dimension == 2 ? 1.0 : 4.0 / 3.0 * disc.radius);
  const double mass = disc.ratio * volume, inertia = (dimension == 2 ? 0.5 : 0.4) * mass * r2;
  protocol::Particle p{{1, {disc.start.x(), disc.start.y(), disc.start.z()}, {}, {}},
                       {1, disc.radius, mass, inertia, 1}};
  FreeRun run;
  for (int s = 0; s < disc.steps; s += disc.fluid_steps) {
    const bool there = s >= disc.inserted;
    particles.arrive(std::span(&p, there ? 1 : 0), interval);
    for (int k = 0; k < disc.fluid_steps; ++k) {
      fluid.place(particles.bodies(k));
      fluid.step();
      particles.add(fluid.loads());
    }
    const auto loads = particles.mean_loads(disc.fluid_steps);
    if (!there) continue;
    const protocol::Load& load = loads[0];
    for (int k = 0; k < dimension; ++k) {
      const double a = load.force[k] / mass + scene.fluid.gravity[k];
      p.state.x[k] += interval * (p.state.v[k] + 0.5 * interval * a);
      p.state.v[k] += interval * a;
    }
    for (int k = dimension == 2 ? 2 : 0; k < 3; ++k)
      p.state.omega[k] += interval * load.torque[k] / inertia;
    run.place.emplace_back(p.state.x[0], p.state.x[1], p.state.x[2]);
    run.velocity.emplace_back(p.state.v[0], p.state.v[1], p.state.v[2]);
    run.force_y.push_back(load.force[1]);
    disc.seen();
  }
  return run;
}

}  // namespace test
