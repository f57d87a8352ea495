// SPDX-License-Identifier: GPL-2.0-or-later
#include "lbm_solver/coupling/held_flow.h"

namespace lbm {

HeldFlow::HeldFlow(const Scene& scene, const Plan& plan, const Decomposition& ranks,
                   const std::string& folder, double keep_until)
    : units_(plan.units), to_flow_(plan.units.velocity()) {
  if (scene.box.dimension == 2) to_flow_ *= scene.box.depth;
  for (int k = 0; k < scene.box.dimension; ++k)
    if (k != scene.fluid.flow->axis) to_flow_ *= scene.box.size[k];
  if (ranks.rank() == 0)
    table_.emplace(folder + "/flow.csv",
                   "time [s],flow [m3/s],wanted [m3/s],pressure_gradient [Pa/m]", keep_until);
}

void HeldFlow::write(double time, const Fluid& fluid) {
  const FlowControl& control = *fluid.flow_control();
  flow_ = mean_velocity(fluid, control.axis()) * to_flow_;
  pressure_gradient_ = control.force() * units_.dx / (units_.dt * units_.dt) * units_.density;
  if (!table_) return;
  table_->row({time, flow_, control.wanted(fluid.steps()) * to_flow_, pressure_gradient_});
  table_->flush();
}

void HeldFlow::describe(std::map<std::string, double>& parameters) const {
  parameters["flow"] = flow_;
  parameters["pressure_gradient"] = pressure_gradient_;
}

}  // namespace lbm
