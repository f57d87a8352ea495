// SPDX-License-Identifier: GPL-2.0-or-later
#include "lbm_solver/solver/viscosity_use.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "lbm_solver/viscosity/local_viscosity.h"

namespace lbm {
namespace {

/// What the table wants of a cell: 2 Q_ab Q_ab / rho², without Q's trace or with it.
enum class Trace { Left, Taken };
double stress_of(const Fluid& fluid, int x, int y, int z, Trace with = Trace::Taken) {
  const Lattice& l = fluid.lattice();
  const auto [rho, u] = fluid.cell(x, y, z);
  const Vec3 force = fluid.body_force();
  double q[3][3] = {}, trace = 0.0, squares = 0.0;
  for (int i = 1; i < l.Q; ++i) {
    const double population = fluid.arriving(i, x, y, z);
    for (int a = 0; a < l.D; ++a)
      for (int b = 0; b < l.D; ++b) q[a][b] += population * l.c[i][a] * l.c[i][b];
  }
  for (int a = 0; a < l.D; ++a) {
    q[a][a] -= (rho - 1.0) / 3.0;
    for (int b = 0; b < l.D; ++b)
      q[a][b] += 0.5 * (force[a] * u[b] + u[a] * force[b]) - rho * u[a] * u[b];
    trace += q[a][a];
  }
  for (int a = 0; a < l.D; ++a) {
    if (with == Trace::Taken) q[a][a] -= trace / l.D;
    for (int b = 0; b < l.D; ++b) squares += q[a][b] * q[a][b];
  }
  return 2.0 * squares / (rho * rho);
}

/// As LocalViscosity finds it, of a cell that is open in part.
double tau_of(const Fluid& fluid, const CollisionParameters& p, double open, int x, int y, int z) {
  if (p.viscosity_table) {
    const bool covered = open < 1.0;
    const double part = covered ? LocalViscosity::stress_part(open) : 1.0;
    const auto& table = covered && p.covered_table ? p.covered_table : p.viscosity_table;
    return 1.0 / (*table)(stress_of(fluid, x, y, z) / (part * part));
  }
  const double factor = fluid.eddies() ? fluid.eddies()->row(y, z)[x] : 1.0;
  const double eddies = 18.0 * p.smagorinsky * p.smagorinsky * factor;
  const double stress = std::sqrt(stress_of(fluid, x, y, z, Trace::Left));
  return 0.5 * (p.tau + std::sqrt(p.tau * p.tau + eddies * stress));
}

}  // namespace

void row_viscosity(const Fluid& fluid, const CollisionParameters& parameters, int y, int z,
                   std::span<double> nu) {
  for (int x = 0; x < fluid.cells().size[0]; ++x) {
    const double solid = fluid.cover() ? fluid.cover()->solid_fraction(x, y, z) : 0.0;
    nu[x] = solid >= kWhole ? std::numeric_limits<double>::quiet_NaN()
                            : (tau_of(fluid, parameters, 1.0 - solid, x, y, z) - 0.5) / 3.0;
  }
}

ViscosityUse viscosity_use(const Fluid& fluid, const RelaxationTable& table) {
  const Cell3& n = fluid.cells().size;
  double sums[4] = {0.0, 0.0, 0.0, 0.0}, largest = 0.0;  // cells, at either bound, viscosities
  for (int z = 0; z < n[2]; ++z)
    for (int y = 0; y < n[1]; ++y)
      for (int x = 0; x < n[0]; ++x) {
        if (fluid.cover() && fluid.cover()->solid_fraction(x, y, z) >= kWhole) continue;
        const double stress = stress_of(fluid, x, y, z);
        sums[0] += 1.0;
        sums[1] += stress <= table.lowest();
        sums[2] += stress >= table.highest();
        sums[3] += (1.0 / table(stress) - 0.5) / 3.0;
        largest = std::max(largest, table.shear_rate(stress));
      }
  fluid.ranks().sum(sums);
  const double cells = std::max(1.0, sums[0]);
  return {.at_rest_bound = sums[1] / cells,
          .at_shear_bound = sums[2] / cells,
          .largest_shear = fluid.ranks().max(largest),
          .mean_viscosity = sums[3] / cells};
}

}  // namespace lbm
