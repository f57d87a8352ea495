// SPDX-License-Identifier: GPL-2.0-or-later
#include "lbm_solver/coupling/held_flow.h"

#include <algorithm>

namespace lbm {

bool HeldFlow::wanted_by(const Scene& scene) {
  return scene.fluid.flow || std::ranges::any_of(scene.boundaries, [](const BoundaryScene& b) {
           return b.flow_rate.has_value();
         });
}

HeldFlow::HeldFlow(const Scene& scene, const Plan& plan, const Decomposition& ranks,
                   const std::string& folder, double keep_until)
    : units_(plan.units), by_force_(scene.fluid.flow.has_value()) {
  const bool flat = scene.box.dimension == 2;
  to_flow_ = units_.velocity() * (flat ? scene.box.depth : 1.0);
  if (by_force_) {  // a mean velocity, over the cross-section of the box
    for (int k = 0; k < scene.box.dimension; ++k)
      if (k != scene.fluid.flow->axis) to_flow_ *= scene.box.size[k];
  } else {  // mass a step
    to_flow_ *= flat ? units_.dx : units_.dx * units_.dx;
  }
  if (ranks.rank() == 0)
    table_.emplace(folder + "/flow.csv",
                   std::string("time [s],flow [m3/s],wanted [m3/s],") +
                       (by_force_ ? "pressure_gradient [Pa/m]" : "pressure [Pa]"),
                   keep_until);
}

void HeldFlow::write(double time, const Fluid& fluid) {
  if (by_force_) {
    const FlowControl& control = *fluid.flow_control();
    flow_ = mean_velocity(fluid, control.axis()) * to_flow_;
    wanted_ = control.wanted(fluid.steps()) * to_flow_;
    drive_ = control.force() * units_.dx / (units_.dt * units_.dt) * units_.density;
  } else {
    const PressureControl& control = *fluid.pressure_control();
    flow_ = control.flow() * to_flow_;
    wanted_ = control.wanted(fluid.steps()) * to_flow_;
    drive_ = control.drho() * units_.pressure();
  }
  if (!table_) return;
  table_->row({time, flow_, wanted_, drive_});
  table_->flush();
}

void HeldFlow::describe(std::map<std::string, double>& parameters) const {
  parameters["flow"] = flow_;
  parameters["wanted_flow"] = wanted_;
  parameters[by_force_ ? "pressure_gradient" : "held_pressure"] = drive_;
}

}  // namespace lbm
