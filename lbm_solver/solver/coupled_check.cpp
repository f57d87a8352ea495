// SPDX-License-Identifier: GPL-2.0-or-later
#include "lbm_solver/solver/coupled_check.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "lbm_solver/viscosity/viscosity_law.h"

namespace lbm {
namespace {

constexpr double kDeepRest = 0.05, kDeepHit = 1.0;  // overlap over radius that goes unremarked
constexpr double kThick = 0.1;                      // m²/s: more than any honey
constexpr int kTestedSteps = 10;                    // fluid steps a coupling interval

/// A body force of its own carries the particles' weight along an axis.
bool carried(const Scene& s, int axis) {
  return (s.coupling && s.coupling->carry_weight) || (s.fluid.flow && s.fluid.flow->axis == axis);
}

/// Gravity that points upwards, or that nothing holds.
void check_gravity(const Scene& s, Plan& plan) {
  const int up = s.box.dimension - 1;
  const Vec3& g = s.fluid.gravity;
  if (g[up] > 0.0)
    plan.warnings.push_back(
        fmt::format("fluid.gravity points upwards (+{}): is its sign right?", "xyz"[up]));
  const bool neutral =
      s.particles->density.lo == s.fluid.density && s.particles->density.hi == s.fluid.density;
  for (int k = 0; k < s.box.dimension && !neutral; ++k)
    if (g[k] != 0.0 && s.box.sides[k] == SideKind::Periodic && s.fluid.body_force[k] == 0.0 &&
        !carried(s, k) && s.box.pressure_jump[k] == 0.0)
      plan.warnings.push_back(
          fmt::format("fluid.gravity acts along {0}, where the box is periodic and nothing holds "
                      "the particles: they take the fluid along, faster and faster; take "
                      "sides_{0} = \"wall\", or a fluid.body_force that carries their weight",
                      "xyz"[k]));
}

/// A script includes files by ${scene_folder}, where LIGGGHTS parts words at blanks.
void check_folder(const Scene& s, Plan& plan) {
  const std::string first = s.file.substr(0, s.file.find(" + "));  // overlays follow
  const std::string folder = std::filesystem::path(first).parent_path().string();
  if (folder.find_first_of(" \t") != std::string::npos)
    plan.warnings.push_back(fmt::format(
        "the scene's folder \"{}\" has a blank in its name: LIGGGHTS parts words there, and a "
        "script "
        "that includes ${{scene_folder}}/… stops at \"Illegal include command\"; rename every "
        "folder of this path that has one",
        folder));
}

/// Averages over more steps than were ever compared with fewer.
void check_interval(const Scene& s, Plan& plan) {
  if (s.coupling->fluid_steps > kTestedSteps)
    plan.warnings.push_back(fmt::format(
        "coupling.fluid_steps = {}: a coupling interval of {:.4g} s, {} solid steps; tested are up "
        "to {}, beyond which the particles may move far, or grow unstable, on loads that are out "
        "of date; take fewer",
        s.coupling->fluid_steps, plan.interval(), plan.substeps, kTestedSteps));
}

void check_viscosity(const Scene& s, Plan& plan) {
  const bool law = parts_of(s.fluid.law.model).varies;  // plan_viscosity looks at these
  if (s.fluid.viscosity > kThick && !law)
    plan.warnings.push_back(fmt::format(
        "fluid.kinematic_viscosity = {:.3g} m²/s is unusually large for a liquid (water: 1e-6); "
        "kinematic viscosity is in m²/s",
        s.fluid.viscosity));
}

void check_contacts(const Scene& s, Plan& plan) {
  const ParticleScene& p = *s.particles;
  if (!p.contact_stiffness) return;
  const double r = 0.5 * p.diameter.hi, volume = particle_volume(s, p.diameter.hi);
  const double weight =
      std::max(0.0, p.density.hi - s.fluid.density) * volume * s.fluid.gravity.norm();
  // In parts of the radius: of one particle on another, and where one comes with velocity_scale.
  const double resting = weight / *p.contact_stiffness / r;
  const double hitting =
      s.fluid.velocity_scale * std::sqrt(p.density.hi * volume / *p.contact_stiffness) / r;
  if (resting > kDeepRest)
    plan.warnings.push_back(
        fmt::format("particles.contact_stiffness is soft: under its weight alone a particle sinks "
                    "into another by {:.3g} of its radius; {:.2g} N/m would keep that to {}",
                    resting, *p.contact_stiffness * resting / kDeepRest, kDeepRest));
  else if (hitting > kDeepHit)
    plan.warnings.push_back(
        fmt::format("particles.contact_stiffness is soft: a particle with velocity_scale goes "
                    "through another ({:.3g} of its radius); {:.2g} N/m would stop it at {}",
                    hitting, *p.contact_stiffness * hitting * hitting, kDeepHit));
}

}  // namespace

void check_coupled(const Scene& s, Plan& plan) {
  check_interval(s, plan);
  check_folder(s, plan);
  check_gravity(s, plan);
  check_viscosity(s, plan);
  check_contacts(s, plan);
}

}  // namespace lbm
