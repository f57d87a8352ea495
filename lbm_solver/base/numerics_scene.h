// SPDX-License-Identifier: GPL-2.0-or-later
/// The part of a scene that says how it is computed.
#pragma once

#include <optional>

#include "lbm_solver/base/choices.h"

namespace lbm {

struct NumericsScene {
  std::optional<double> cell;                  ///< [m]
  std::optional<double> cells_per_diameter;    ///< instead of `cell`: of the smallest particle
  std::optional<double> time_step;             ///< fluid step [s]; absent: chosen by rule
  std::optional<VelocitySet> lattice;          ///< absent: D2Q9, D3Q19
  Precision precision = Precision::Double;     ///< of the populations
  std::optional<CollisionOperator> collision;  ///< absent: see solver/plan.h
  std::optional<SolidTerm> solid_term;         ///< absent: see solver/plan.h
  std::optional<SolidScheme> scheme;           ///< absent: the immersed moving boundary
  double spring_stiffness = 0.001;             ///< of the spring scheme, lattice units
  std::optional<WeightRule> weight;            ///< absent: viscous, in three dimensions balanced
  std::optional<double> magic;                 ///< Λ of TRT; absent: see solver/plan.h
  double smagorinsky = 0.0;                    ///< S_c; 0: no turbulence model
  EddyModel eddies = EddyModel::Smagorinsky;   ///< of the turbulence model
  bool equal_work = false;     ///< blocks of the ranks: of equal work instead of equal size
  double waiting_bound = 0.1;  ///< share of waiting above which those are cut anew
};

}  // namespace lbm
