// SPDX-License-Identifier: GPL-2.0-or-later
/// Critical time steps of the solid, paper A Eqs 7-13, as functions of one particle or pair.
#pragma once

#include <string>
#include <vector>

namespace dem {

/// A particle, or a pair of equal ones, with its springs. SI units.
struct StepCase {
  std::string what;               ///< for the table
  double mass = 0.0;              ///< of the lighter particle [kg]
  double inertia = 0.0;           ///< of that particle [kg m²]
  double radius = 0.0;            ///< [m]
  double normal_stiffness = 0.0;  ///< the largest of contact and bond [N/m]
  double shear_stiffness = 0.0;   ///< [N/m]
  double damping_ratio = 0.0;     ///< ξ
  bool three_dimensional = false;
};

struct StepLimit {
  std::string rule;   ///< name and equation
  double step = 0.0;  ///< [s], before any safety factor
};

/// Every limit of one case, in the order of the paper:
///   single spring (7)         2 √(m/k)
///   many springs (8)          √(m/k), and √(I/k_rot) with k_rot = K_t R²
///   O'Sullivan and Bray       0.3 √(m/k) discs, 0.17 √(m/k) spheres
///   damped spring (11)        2 √(m/k) (√(1+ξ²) - ξ)
///   damped springs (12)       √(m/k) (√(1+ξ²) - ξ), the papers' choice
/// k is the larger of normal and shear stiffness.
std::vector<StepLimit> step_limits(const StepCase& c);

/// Rayleigh wave (9, 10): π R_mean/η √(ρ/G), η = 0.8766 + 0.1631 ν.
double rayleigh_limit(double mean_radius, double density, double shear_modulus,
                      double poisson_ratio);

}  // namespace dem
