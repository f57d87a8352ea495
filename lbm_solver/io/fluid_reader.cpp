// SPDX-License-Identifier: GPL-2.0-or-later
#include "lbm_solver/io/fluid_reader.h"

#include <fmt/core.h>

#include <algorithm>

#include "lbm_solver/io/time_table_reader.h"
#include "lbm_solver/viscosity/viscosity_law.h"

namespace lbm {
namespace {

using ViscosityModel = ViscosityScene::Model;

/// Keys of the laws that a model has not.
void refuse_other_keys(TableReader& t, ViscosityModel model) {
  const ViscosityParts parts = parts_of(model);
  const auto refuse = [&](bool known, std::initializer_list<const char*> keys) {
    for (const char* key : keys)
      if (!known && t.has(key))
        t.fail(key, "has no meaning with model = \"" + name_of(model) + "\"", "leave it out");
  };
  refuse(parts.varies, {"nu_min", "nu_max", "shear_rate"});
  refuse(parts.consistency, {"consistency"});
  refuse(parts.index, {"index"});
  refuse(parts.yield_stress, {"yield_stress", "regularisation"});
  refuse(parts.time_constant, {"time_constant"});
}

ViscosityScene read_viscosity(TableReader t) {
  ViscosityScene v;
  std::vector<std::string> names;
  for (const ViscosityModel model : known_viscosities()) names.push_back(name_of(model));
  const std::string name = t.choice_or("model", name_of(ViscosityModel::Newtonian), names);
  v.model = known_viscosities()[std::ranges::find(names, name) - names.begin()];
  refuse_other_keys(t, v.model);
  const ViscosityParts parts = parts_of(v.model);
  if (parts.consistency)
    v.consistency = t.number("consistency", Bounds::positive(), parts.index ? "Pa sⁿ" : "Pa s");
  if (parts.index) v.index = t.number("index", {0.1, 2.0}, "");
  if (parts.bounds && parts.index && v.index >= 1.0)
    t.fail("index",
           fmt::format("= {:.6g} does not thin: model = \"{}\" goes from nu_max at rest to nu_min, "
                       "which n < 1 does",
                       v.index, name),
           v.index == 1.0 ? "take n < 1, or model = \"newtonian\""
                          : "take n < 1; what thickens is a power_law with n > 1");
  if (parts.time_constant) v.time_constant = t.number("time_constant", Bounds::positive(), "s");
  if (parts.yield_stress) {
    v.yield_stress = t.number("yield_stress", Bounds::positive(), "Pa");
    if (t.choice_or("regularisation", "bi_viscosity", {"bi_viscosity", "papanastasiou"}) !=
        "bi_viscosity")
      v.regularisation = ViscosityScene::Regularisation::Papanastasiou;
  }
  v.nu_min = t.optional_number("nu_min", Bounds::positive(), "m²/s");
  v.nu_max = t.optional_number("nu_max", Bounds::positive(), "m²/s");
  v.shear_rate = t.optional_number("shear_rate", Bounds::positive(), "1/s");
  if (parts.bounds && !(v.nu_min && v.nu_max))
    t.fail(v.nu_min ? "nu_max" : "nu_min", "is missing",
           "the law goes from nu_max at rest to nu_min at high shear rates");
  if (v.nu_min && v.nu_max && *v.nu_min >= *v.nu_max)
    t.fail("nu_min",
           fmt::format("= {:.6g} m²/s is not below nu_max = {:.6g} m²/s", *v.nu_min, *v.nu_max),
           "give nu_min < nu_max");
  v.smagorinsky = t.number_or("smagorinsky", 0.0, {0.0, 1.0}, "");
  if (v.model == ViscosityModel::Smagorinsky && v.smagorinsky == 0.0)
    t.fail("smagorinsky", "is missing or 0", "give the constant S_c, e.g. 0.1");
  t.finish();
  return v;
}

std::optional<FlowScene> read_flow(TableReader& t, int d) {
  std::vector<std::string> axes{"x", "y", "z"};
  axes.resize(d);
  FlowScene flow;
  const auto rate = t.optional_number("flow_rate", {}, "m³/s");
  flow.axis = t.choice_or("flow_axis", "x", axes)[0] - 'x';
  flow.ramp = t.number_or("flow_ramp", 0.0, Bounds::non_negative(), "s");
  if (!rate) {
    for (const char* key : {"flow_axis", "flow_ramp"})
      if (t.has(key)) t.fail(key, "has no meaning without flow_rate", "leave it out");
    return {};
  }
  flow.rate = *rate;
  return flow;
}

}  // namespace

FluidScene read_fluid(TableReader t, int d, const std::string& scene_file) {
  FluidScene fluid;
  fluid.density = t.number("density", Bounds::positive(), "kg/m³");
  if (t.has("viscosity")) fluid.law = read_viscosity(t.table("viscosity"));
  const bool varies = parts_of(fluid.law.model).varies;
  if (varies && t.has("kinematic_viscosity"))
    t.fail("kinematic_viscosity",
           "stands beside a viscosity that depends on the shear rate, model = \"" +
               name_of(fluid.law.model) + "\"",
           "leave it out");
  if (!varies) fluid.viscosity = t.number("kinematic_viscosity", Bounds::positive(), "m²/s");
  fluid.gravity = t.vector_or_zero("gravity", d, "[m/s²]");
  fluid.body_force = t.vector_or_zero("body_force", d, "[m/s²]");
  fluid.body_force_ramp = t.number_or("body_force_ramp", 0.0, Bounds::non_negative(), "s");
  fluid.body_force_frequency =
      t.number_or("body_force_frequency", 0.0, Bounds::non_negative(), "Hz");
  fluid.body_force_table =
      read_time_table(t, "body_force_table",
                      t.choice_or("body_force_repeat", "once", {"once", "periodic"}), scene_file);
  fluid.flow = read_flow(t, d);
  for (const char* key : {"body_force_frequency", "body_force_table"})
    if (t.has(key) && fluid.body_force.norm() == 0.0)
      t.fail(key, "stands beside a body_force of zero", "give body_force, or leave it out");
  if (fluid.body_force_ramp > 0.0 && fluid.body_force.norm() == 0.0)
    t.fail("body_force_ramp", "stands beside a body_force of zero",
           "give body_force, or leave it out");
  fluid.velocity_scale = t.number("velocity_scale", Bounds::positive(), "m/s");
  t.finish();
  return fluid;
}

void settle_viscosity(const TableReader& root, Scene& scene) {
  ViscosityScene& law = scene.fluid.law;
  double& constant = scene.numerics.smagorinsky;
  if (law.smagorinsky > 0.0 && constant > 0.0)
    root.fail("fluid.viscosity.smagorinsky", "stands beside numerics.smagorinsky",
              "give one of them");
  constant = std::max(constant, law.smagorinsky);
  if (scene.numerics.eddies == EddyModel::Wale && constant == 0.0)
    root.fail("numerics.eddy_viscosity", "= \"wale\" stands without its constant",
              "give numerics.smagorinsky, e.g. 0.1");
  if (scene.numerics.eddies == EddyModel::Wale && parts_of(law.model).varies)
    root.fail(
        "numerics.eddy_viscosity",
        "= \"wale\" stands beside a viscosity that depends on the shear rate, whose table has "
        "Smagorinsky's",
        "leave it out");
  if (!law.shear_rate) law.shear_rate = typical_shear_rate(scene);
  scene.fluid.viscosity = ViscosityLaw(scene.fluid, *law.shear_rate).reference();
}

}  // namespace lbm
