// SPDX-License-Identifier: GPL-2.0-or-later
#include "lbm_solver/coupling/scene_parameters.h"

#include <fmt/core.h>

namespace lbm {

std::map<std::string, double> scene_parameters(const Scene& scene, const Plan& plan) {
  std::map<std::string, double> parameters{{"cell", plan.units.dx},
                                           {"time_step", plan.units.dt},
                                           {"interval", plan.interval()},
                                           {"tau", plan.kernel.parameters.tau},
                                           {"density", scene.fluid.density},
                                           {"kinematic_viscosity", scene.fluid.viscosity},
                                           {"gravity_x", scene.fluid.gravity.x()},
                                           {"gravity_y", scene.fluid.gravity.y()},
                                           {"depth", scene.box.depth},
                                           {"box_x", scene.box.size.x()},
                                           {"box_y", scene.box.size.y()},
                                           {"velocity_scale", scene.fluid.velocity_scale}};
  if (scene.box.dimension == 3) {
    parameters["box_z"] = scene.box.size.z();
    parameters["gravity_z"] = scene.fluid.gravity.z();
  }
  if (scene.particles) {
    parameters["diameter"] = scene.particles->diameter.hi;
    parameters["particle_density"] = scene.particles->density.hi;
    parameters["cells_per_diameter"] = plan.cells_per_diameter;
  }
  const FluidScene& fluid = scene.fluid;
  const bool steady = fluid.body_force_frequency == 0.0 && fluid.body_force_table.times.empty();
  for (int k = 0; k < scene.box.dimension; ++k) {
    if (fluid.body_force[k] != 0.0 && steady)
      parameters[fmt::format("body_force_{}", "xyz"[k])] = fluid.body_force[k];
    if (scene.box.pressure_jump[k] != 0.0)
      parameters[fmt::format("pressure_jump_{}", "xyz"[k])] = scene.box.pressure_jump[k];
  }
  return parameters;
}

}  // namespace lbm
