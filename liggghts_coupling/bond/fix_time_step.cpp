// SPDX-License-Identifier: GPL-2.0-or-later
#include "liggghts_coupling/bond/fix_time_step.h"

#include <atom.h>
#include <comm.h>
#include <domain.h>
#include <error.h>
#include <fmt/core.h>
#include <force.h>
#include <update.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "liggghts_coupling/bond/arguments.h"
#include "liggghts_coupling/bond/pair_property.h"

namespace dem {

FixTimeStep::FixTimeStep(LAMMPS_NS::LAMMPS* lammps, int narg, char** arg) : Fix(lammps, narg, arg) {
  bool lambda = false;
  for (int k = 3; k < narg;) {
    const std::string word = arg[k];
    if (word == "lambda" && k + 1 < narg) {
      lambda_ = argument<double>(error, this, word, arg[k + 1]);
      lambda = true;
      k += 2;
    } else if (word == "fit" && k + 1 < narg) {
      interval_ = argument<double>(error, this, word, arg[k + 1]);
      k += 2;
    } else if (word == "elastic" && k + 2 < narg) {
      shear_modulus_ = argument<double>(error, this, word, arg[k + 1]);
      poisson_ratio_ = argument<double>(error, this, word, arg[k + 2]);
      k += 3;
    } else {
      error->fix_error(FLERR, this, "expects 'lambda L [fit INTERVAL] [elastic G NU]'");
    }
  }
  if (!lambda || lambda_ <= 0.0 || lambda_ > 1.0)
    error->fix_error(FLERR, this, "needs 'lambda L' above 0 and at most 1; the papers take 0.1");
}

FixTimeStep::Lightest FixTimeStep::lightest(int type) const {
  double mine[2] = {std::numeric_limits<double>::max(), std::numeric_limits<double>::max()};
  for (int i = 0; i < atom->nlocal; ++i) {
    if (atom->type[i] != type) continue;
    mine[0] = std::min(mine[0], atom->rmass[i]);
    mine[1] = std::min(mine[1], atom->radius[i]);
  }
  double all[2];
  MPI_Allreduce(mine, all, 2, MPI_DOUBLE, MPI_MIN, world);
  const double shape = domain->dimension == 2 ? 0.5 : 0.4;
  return {all[0], shape * all[0] * all[1] * all[1], all[1]};
}

void FixTimeStep::say(const std::string& text) const {
  if (comm->me != 0) return;
  for (FILE* out : {screen, logfile})
    if (out) std::fputs(text.c_str(), out);
}

double FixTimeStep::rayleigh() const {
  double mine[3] = {0.0, 0.0, 0.0};
  for (int i = 0; i < atom->nlocal; ++i) {
    mine[0] += atom->radius[i];
    mine[1] += atom->density[i];
    mine[2] += 1.0;
  }
  double all[3];
  MPI_Allreduce(mine, all, 3, MPI_DOUBLE, MPI_SUM, world);
  return rayleigh_limit(all[0] / all[2], all[1] / all[2], *shear_modulus_, poisson_ratio_);
}

/// Every pair of types of which there are particles, with the stiffest springs.
std::vector<StepCase> FixTimeStep::cases() {
  const auto values = [this](const char* name) { return pair_property(*lmp, name, style); };
  const double* const* contact = values("contactNormalStiffness");
  const double* const* shear = values("contactShearStiffness");
  const double* const* damping = values("contactDampingRatio");
  const double* const* bond = values("bondNormalStiffness");
  const double* const* bond_shear = values("bondShearStiffness");
  if (!contact || !shear || !damping || !bond || !bond_shear)
    error->fix_error(FLERR, this, "needs the properties of pair_style gran model bond/contact");
  std::vector<StepCase> all;
  for (int a = 1; a <= atom->ntypes; ++a)
    for (int b = a; b <= atom->ntypes; ++b) {
      const Lightest one = lightest(a), two = lightest(b);
      const Lightest& light = one.mass < two.mass ? one : two;
      if (light.mass == std::numeric_limits<double>::max()) continue;  // no particle of the type
      all.push_back({fmt::format("types {} and {}", a, b), light.mass, light.inertia, light.radius,
                     std::max(contact[a - 1][b - 1], bond[a - 1][b - 1]),
                     std::max(shear[a - 1][b - 1], bond_shear[a - 1][b - 1]), damping[a - 1][b - 1],
                     domain->dimension == 3});
    }
  return all;
}

/// Prints every limit.
FixTimeStep::Critical FixTimeStep::critical() {
  const std::vector<StepCase> all = cases();
  Critical critical{std::numeric_limits<double>::max(), {}};
  say(fmt::format("time step limits (before the factor lambda = {}):\n", lambda_));
  for (const StepCase& c : all)
    for (const StepLimit& limit : step_limits(c)) {
      say(fmt::format("  {:14} {:28} {:.4e} s\n", c.what, limit.rule, limit.step));
      const bool judged = limit.rule.find("Eq 12") != std::string::npos ||
                          limit.rule.find("turning") != std::string::npos;
      if (judged && limit.step < critical.step) critical = {limit.step, c.what + ", " + limit.rule};
    }
  if (!shear_modulus_) return critical;
  const double limit = rayleigh();
  say(fmt::format("  {:14} {:28} {:.4e} s\n", "material", "Rayleigh wave, Eq 9", limit));
  if (limit < critical.step) critical = {limit, "Rayleigh wave, Eq 9"};
  return critical;
}

void FixTimeStep::init() {
  const auto [critical, binding] = this->critical();
  const double most = lambda_ * critical;
  if (interval_) {
    update->dt = *interval_ / std::ceil(*interval_ / most - 1e-9);
    say(fmt::format("  time step set to {:.6e} s, 1/{:.0f} of {:.6e} s; {} binds\n", update->dt,
                    *interval_ / update->dt, *interval_, binding));
  } else if (update->dt > most * (1.0 + 1e-9)) {
    error->fix_error(FLERR, this,
                     fmt::format("time step {:.4e} s exceeds lambda × {:.4e} s ({}); take at most "
                                 "{:.4e} s",
                                 update->dt, critical, binding, most)
                         .c_str());
  } else {
    say(fmt::format("  time step {:.4e} s is {:.3f} of the critical one; {} binds\n", update->dt,
                    update->dt / critical, binding));
  }
}

}  // namespace dem
