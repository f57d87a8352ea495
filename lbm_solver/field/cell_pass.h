// SPDX-License-Identifier: GPL-2.0-or-later
/// Moments and equilibrium of one cell on any lattice at run time, for passes over cells and links.
/// The sweep has the same equations on packs in `collision/equilibrium.h`.
#pragma once

#include "lbm_solver/field/esoteric_pull.h"

namespace lbm {

inline Vec3 velocity_of(const Lattice& l, int q) {
  return {static_cast<double>(l.c[q][0]), static_cast<double>(l.c[q][1]),
          static_cast<double>(l.c[q][2])};
}

/// 9/2 (c_q·u)² - 3/2 u²
inline double square_terms(const Lattice& l, int q, const Vec3& u) {
  const double cu = velocity_of(l, q).dot(u);
  return 4.5 * cu * cu - 1.5 * u.squaredNorm();
}

/// f_q^eq - w_q of a density deviation and a velocity.
inline double equilibrium(const Lattice& l, int q, double drho, const Vec3& u) {
  const double momentum = 3.0 * velocity_of(l, q).dot(u) + square_terms(l, q, u);
  return l.w[q] * (drho + (1.0 + drho) * momentum);
}

/// Density deviation and momentum of the populations that have arrived at a cell.
struct CellMoments {
  double drho = 0.0;
  Vec3 j;
  Vec3 velocity() const { return j / (1.0 + drho); }
};
inline CellMoments cell_moments(const Populations& f, const EsotericPull& stream, int x, int y,
                                int z) {
  CellMoments m;
  for (int q = 0; q < f.lattice().Q; ++q) {
    const double here = stream.arriving(f, q, x, y, z);
    m.drho += here;
    m.j += here * velocity_of(f.lattice(), q);
  }
  return m;
}

/// Sets what has arrived at a cell to an equilibrium.
inline void set_equilibrium(Populations& f, const EsotericPull& stream, const Cell3& cell,
                            double drho, const Vec3& u) {
  for (int q = 0; q < f.lattice().Q; ++q)
    stream.arriving(f, q, cell[0], cell[1], cell[2]) = equilibrium(f.lattice(), q, drho, u);
}

}  // namespace lbm
