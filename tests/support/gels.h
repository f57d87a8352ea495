// SPDX-License-Identifier: GPL-2.0-or-later
/// Fluids whose viscosity depends on the shear rate, in lattice units.
#pragma once

#include <cmath>
#include <memory>

#include "lbm_solver/solver/fluid.h"
#include "lbm_solver/viscosity/mean_law.h"
#include "lbm_solver/viscosity/viscosity_law.h"

namespace test {

using namespace lbm;
using Regularisation = ViscosityScene::Regularisation;

/// A Herschel–Bulkley fluid in lattice units, density 1; nu_w is its viscosity at a shear rate of
/// the flow.
struct Gel {
  double index = 1.0, yield_part = 0.0;  ///< σ_y over the stress at that shear rate
  double span = 100.0;                   ///< nu_max over nu_w
  double thinnest = 1e-2;                ///< nu_min over nu_w
  Regularisation regularisation = Regularisation::BiViscosity;

  ViscosityLaw law(double tau, double shear_rate) const {
    const double nu = (tau - 0.5) / 3.0, stress = nu * shear_rate;
    FluidScene fluid{.density = 1.0};
    fluid.law = {.model = ViscosityScene::Model::HerschelBulkley,
                 .consistency = (1.0 - yield_part) * stress / std::pow(shear_rate, index),
                 .index = index,
                 .yield_stress = yield_part * stress,
                 .nu_min = nu * thinnest,
                 .nu_max = nu * span,
                 .regularisation = regularisation};
    return {fluid, shear_rate};
  }
  /// Shear rate of the fluid without bounds at a stress, in units of those it was made for.
  double shear_rate(double stress) const {
    return stress > yield_part ? std::pow((stress - yield_part) / (1.0 - yield_part), 1.0 / index)
                               : 0.0;
  }
};

inline CollisionParameters parameters(const ViscosityLaw& law, double tau, double force = 0.0) {
  CollisionParameters p{.tau = tau, .force_x = force};
  p.viscosity_table =
      std::make_shared<RelaxationTable>([law](double rate) { return 0.5 + 3.0 * law(rate); });
  return p;
}

/// The same beside bodies of a radius, as a plan has it.
inline CollisionParameters parameters_beside(double radius, int dimension, const ViscosityLaw& law,
                                             double tau) {
  CollisionParameters p = parameters(law, tau);
  p.covered_table = std::make_shared<RelaxationTable>(
      MeanLaw([law](double rate) { return 0.5 + 3.0 * law(rate); },
              MeanLaw::spread_beside(radius, dimension)));
  return p;
}

/// Runs until a number changes by less than 1e-7 in 1000 steps; at most `most` steps.
template <class Number>
double settled(Fluid& fluid, int most, const Number& number) {
  double before = number();
  for (int step = 0; step < most; step += 1000) {
    fluid.advance(1000);
    const double now = number();
    if (std::abs(now - before) < 1e-7 * std::abs(now)) return now;
    before = now;
  }
  return before;
}

}  // namespace test
