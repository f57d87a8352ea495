// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <string>
#include <vector>

#include "lbm_solver/base/scene.h"

namespace lbm {

/// Kinematic viscosity of a fluid at a shear rate γ̇ = √(2 S_ab S_ab), in SI units:
///   newtonian        nu
///   power_law        (K/rho) γ̇^(n-1)                                     [Ostwald, de Waele]
///   carreau          nu_min + (nu_max - nu_min) (1 + (λ γ̇)²)^((n-1)/2)   [Carreau1972]
///   bingham          (K + σ_y/γ̇)/rho, K a plastic viscosity              [Bingham1922]
///   herschel_bulkley (K γ̇^(n-1) + σ_y/γ̇)/rho                             [HerschelBulkley1926]
/// all within nu_min … nu_max. Below the yield stress σ_y the material creeps with nu_max instead
/// of standing still. How it comes there is the regularisation:
///   bi_viscosity     the smaller one of nu_max and the law: exact wherever the law is below nu_max
///   papanastasiou    σ_y (1 - e^(-m γ̇))/γ̇ in place of σ_y/γ̇, m = rho nu_max/σ_y
///   [Papanastasiou1987]
/// Smagorinsky's model adds its eddy viscosity in the kernel, and is Newtonian here.
class ViscosityLaw {
 public:
  /// Takes nu_min and nu_max, where the scene leaves them open, a hundredth and a hundred times the
  /// viscosity at the typical shear rate; nu_min of a Bingham fluid is at most K/rho, below which
  /// it never comes.
  /// @param shear_rate  the typical one [1/s]
  ViscosityLaw(const FluidScene& fluid, double shear_rate);

  /// @param shear_rate  [1/s], not negative @return  [m²/s]
  double operator()(double shear_rate) const;

  bool newtonian() const;
  double shear_rate() const { return shear_rate_; }
  /// At the typical shear rate [m²/s].
  double reference() const { return (*this)(shear_rate_); }
  double nu_min() const { return nu_min_; }  ///< [m²/s]
  double nu_max() const { return nu_max_; }  ///< [m²/s]

 private:
  double unbounded(double shear_rate) const;

  ViscosityScene scene_;
  double newtonian_;            // [m²/s]
  double consistency_, yield_;  // over the density
  double shear_rate_;
  double nu_min_ = 0.0, nu_max_ = 0.0;  // 0: not known yet
};

/// Shear rate that a scene is likely to have, where it does not say [1/s]: its velocity scale over
/// the smallest of particle diameters, diameters of round obstacles and half-widths between walls;
/// over the box's smallest length where it has none of them.
double typical_shear_rate(const Scene& scene);

/// What a law is made of: whether the viscosity depends on the shear rate, and the keys of
/// `fluid.viscosity` that it has beside nu_min, nu_max and shear_rate.
struct ViscosityParts {
  bool varies = false;
  bool consistency = false, index = false;
  bool yield_stress = false;  ///< and regularisation
  bool time_constant = false;
  bool bounds = false;  ///< nu_min and nu_max are parts of the law, and must be given
};
ViscosityParts parts_of(ViscosityScene::Model model);

/// As a scene writes it, e.g. "power_law".
std::string name_of(ViscosityScene::Model model);
std::vector<ViscosityScene::Model> known_viscosities();

}  // namespace lbm
