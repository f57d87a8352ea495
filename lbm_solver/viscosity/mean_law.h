// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <vector>

#include "lbm_solver/viscosity/relaxation_table.h"

namespace lbm {

/// The law of a cell across which the stress varies, as beside a round surface: of stresses σ
/// between s (1 - a) and s (1 + a), all alike, the mean shear rate is
///   γ̄(s) = 1/(2 a s) ∫ γ̇(σ) dσ,   τ = ½ + s/γ̄.
/// Smooth laws hardly change (second order in a); a fluid with a yield stress begins to yield where
/// the largest of the stresses does. Lattice units.
class MeanLaw {
 public:
  /// @param tau     relaxation time of a shear rate @param spread  a, 0 … 1, without its ends
  MeanLaw(const std::function<double(double)>& tau, double spread);

  /// Relaxation time of a mean shear rate.
  double operator()(double shear_rate) const;

  /// Spread in cells that a body covers in part, whose fluid is half a cell wide on average: beside
  /// a round surface the balance of moments makes the shear stress fall as r⁻² (discs) and r⁻³
  /// (spheres). @param radius  in cells
  static double spread_beside(double radius, int dimension) {
    return std::min(0.5, (dimension == 3 ? 0.75 : 0.5) / radius);
  }

 private:
  std::vector<double> rates_, stresses_;  // logarithms
};

}  // namespace lbm
