// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <mpi.h>

#include <optional>
#include <string>
#include <vector>
// clang-format off
#include <lammps.h>
#include <fix.h>
// clang-format on

#include "liggghts_coupling/bond/time_step_limits.h"

namespace dem {

/// fix ID all bond/timestep lambda L [fit INTERVAL] [elastic G NU]
///
/// At the beginning of each run prints the limits of paper A Eqs 7-12 for every pair of types, with
/// the lightest particle of either, names the one that binds, and refuses a time step above
/// L × Eq 12 (Eq 13; the papers take L = 0.1 … 0.2). `fit` sets the time step instead: the largest
/// whole fraction of INTERVAL [s] below that. `elastic` adds the Rayleigh limit of a material of
/// shear modulus G [Pa] and Poisson ratio NU.
class FixTimeStep final : public LAMMPS_NS::Fix {
 public:
  FixTimeStep(LAMMPS_NS::LAMMPS* lammps, int narg, char** arg);
  int setmask() override { return 0; }
  void init() override;

 private:
  struct Lightest {
    double mass, inertia, radius;
  };
  Lightest lightest(int type) const;
  void say(const std::string& text) const;
  double rayleigh() const;
  /// The smallest limit that is judged, before the factor.
  struct Critical {
    double step;
    std::string binding;
  };
  std::vector<StepCase> cases();
  Critical critical();

  double lambda_ = 0.1;
  std::optional<double> interval_, shear_modulus_;
  double poisson_ratio_ = 0.0;
};

}  // namespace dem
