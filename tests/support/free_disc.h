// SPDX-License-Identifier: GPL-2.0-or-later
/// A disc that a solid program would integrate, coupled as the programs are.
#pragma once

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
  int fluid_steps = 1;                            ///< a coupling interval
  std::string solid_term = "layered_resistance";  ///< of the fluid's kernel
};

/// Of each interval in which the disc was there: place and velocity at its end, mean force.
struct FreeRun {
  std::vector<Vec3> place, velocity;
  std::vector<double> force_y;
};

inline FreeRun free_run(Fluid& fluid, const Scene& scene, const FreeDisc& disc) {
  Particles particles({1.0, 1.0, 1.0, 1.0, {0.0, 0.0}}, scene, fluid.domain(), disc.solid_term);
  const double mass = disc.ratio * std::numbers::pi * disc.radius * disc.radius;
  const double interval = disc.fluid_steps;
  protocol::Particle p{{1, {disc.start.x(), disc.start.y(), 0.0}, {}, {}},
                       {1, disc.radius, mass, 0.5 * mass * disc.radius * disc.radius, 1}};
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
    for (int k = 0; k < 2; ++k) {
      const double a = load.force[k] / mass + scene.fluid.gravity[k];
      p.state.x[k] += interval * (p.state.v[k] + 0.5 * interval * a);
      p.state.v[k] += interval * a;
    }
    p.state.omega[2] += interval * load.torque[2] / p.shape.inertia;
    run.place.emplace_back(p.state.x[0], p.state.x[1]);
    run.velocity.emplace_back(p.state.v[0], p.state.v[1]);
    run.force_y.push_back(load.force[1]);
  }
  return run;
}

}  // namespace test
