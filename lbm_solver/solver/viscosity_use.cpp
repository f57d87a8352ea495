// SPDX-License-Identifier: GPL-2.0-or-later
#include "lbm_solver/solver/viscosity_use.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "lbm_solver/viscosity/local_viscosity.h"

namespace lbm {
namespace {

constexpr double kAtBound = 1e-3;  // a viscosity that differs by less is at its bound

/// Second moments of a cell's non-equilibrium populations, as the kernel has them, over rho.
using Moments2 = std::array<std::array<double, 3>, 3>;
Moments2 stress_of(const Fluid& fluid, int x, int y, int z) {
  const Lattice& l = fluid.lattice();
  const auto [rho, u] = fluid.cell(x, y, z);
  const Vec3 force = fluid.body_force();
  Moments2 q{};
  for (int i = 1; i < l.Q; ++i) {
    const double population = fluid.arriving(i, x, y, z);
    for (int a = 0; a < l.D; ++a)
      for (int b = 0; b < l.D; ++b) q[a][b] += population * l.c[i][a] * l.c[i][b];
  }
  for (int a = 0; a < l.D; ++a) {
    q[a][a] -= (rho - 1.0) / 3.0;
    for (int b = 0; b < l.D; ++b) {
      q[a][b] += 0.5 * (force[a] * u[b] + u[a] * force[b]) - rho * u[a] * u[b];
      q[a][b] /= rho;
    }
  }
  return q;
}

/// Q without its trace.
void leave_trace(Moments2& q, int dimension) {
  const double mean = (q[0][0] + q[1][1] + q[2][2]) / dimension;
  for (int a = 0; a < dimension; ++a) q[a][a] -= mean;
}

double squares(const Moments2& q) {
  double sum = 0.0;
  for (const auto& row : q)
    for (const double part : row) sum += 2.0 * part * part;
  return sum;
}

/// What a table says of a cell that is open in part, as LocalViscosity does.
struct LookUp {
  const RelaxationTable* table;
  double stress;  ///< of its fluid: 2 Q_ab Q_ab / rho²
};
LookUp look_up(const Fluid& fluid, const CollisionParameters& p, double open, int x, int y, int z) {
  Moments2 q = stress_of(fluid, x, y, z);
  leave_trace(q, fluid.lattice().D);
  if (open >= 1.0) return {p.viscosity_table.get(), squares(q)};
  const auto square = [&](int a, int b) { return q[a][b] * q[a][b]; };
  return {p.covered_table ? p.covered_table.get() : p.viscosity_table.get(),
          LocalViscosity::fluid_squares(square(0, 0) + square(1, 1) + square(2, 2), square(0, 1),
                                        square(0, 2), square(1, 2), open)};
}

double tau_of(const Fluid& fluid, const CollisionParameters& p, double open, int x, int y, int z) {
  if (p.viscosity_table) {
    const auto [table, stress] = look_up(fluid, p, open, x, y, z);
    return 1.0 / (*table)(stress);
  }
  const double factor = fluid.eddies() ? fluid.eddies()->row(y, z)[x] : 1.0;
  const double eddies = 18.0 * p.smagorinsky * p.smagorinsky * factor;
  const double stress = std::sqrt(squares(stress_of(fluid, x, y, z)));
  return 0.5 * (p.tau + std::sqrt(p.tau * p.tau + eddies * stress));
}

/// Viscosity of the law alone, without an eddy viscosity S_c² γ̇ on top.
double law_viscosity(const RelaxationTable& table, double stress, double smagorinsky) {
  return (1.0 / table(stress) - 0.5) / 3.0 - smagorinsky * smagorinsky * table.shear_rate(stress);
}

/// What the law is at rest, and where its table ends.
struct Bounds {
  double rest, shear;
  static Bounds of(const RelaxationTable* table, double smagorinsky) {
    if (!table) return {0.0, 0.0};
    return {law_viscosity(*table, 0.0, smagorinsky),
            law_viscosity(*table, table->highest(), smagorinsky)};
  }
};

bool is_at(double viscosity, double bound) {
  return std::abs(viscosity - bound) <= kAtBound * bound;
}

/// Part of a cell that is fluid.
double open_part(const Fluid& fluid, int x, int y, int z) {
  const double solid = fluid.cover() ? fluid.cover()->solid_fraction(x, y, z) : 0.0;
  return solid >= kWhole ? 0.0 : 1.0 - solid;
}

}  // namespace

void row_viscosity(const Fluid& fluid, const CollisionParameters& parameters, int y, int z,
                   std::span<double> nu) {
  for (int x = 0; x < fluid.cells().size[0]; ++x) {
    const double open = open_part(fluid, x, y, z);
    nu[x] = open == 0.0 ? std::numeric_limits<double>::quiet_NaN()
                        : (tau_of(fluid, parameters, open, x, y, z) - 0.5) / 3.0;
  }
}

ViscosityUse viscosity_use(const Fluid& fluid, const CollisionParameters& parameters) {
  constexpr double sliver = 0.5;  // less of a cell says little of the largest shear rate
  const Cell3& n = fluid.cells().size;
  double sums[4] = {0.0, 0.0, 0.0, 0.0}, largest = 0.0;  // fluid, at either bound, viscosities
  const Bounds whole = Bounds::of(parameters.viscosity_table.get(), parameters.smagorinsky),
               covered = Bounds::of(parameters.covered_table.get(), parameters.smagorinsky);
  for (int z = 0; z < n[2]; ++z)
    for (int y = 0; y < n[1]; ++y)
      for (int x = 0; x < n[0]; ++x) {
        const double open = open_part(fluid, x, y, z);
        if (open == 0.0) continue;
        const auto [table, stress] = look_up(fluid, parameters, open, x, y, z);
        sums[0] += open;
        const Bounds& bound = table == parameters.viscosity_table.get() ? whole : covered;
        const double nu = law_viscosity(*table, stress, parameters.smagorinsky);
        if (is_at(nu, bound.rest)) sums[1] += open;
        if (is_at(nu, bound.shear)) sums[2] += open;
        sums[3] += open * (1.0 / (*table)(stress)-0.5) / 3.0;
        if (open >= sliver) largest = std::max(largest, table->shear_rate(stress));
      }
  fluid.ranks().sum(sums);
  const double all = sums[0] > 0.0 ? sums[0] : 1.0;
  return {.at_rest_bound = sums[1] / all,
          .at_shear_bound = sums[2] / all,
          .largest_shear = fluid.ranks().max(largest),
          .mean_viscosity = sums[3] / all};
}

}  // namespace lbm
