// SPDX-License-Identifier: GPL-2.0-or-later
/// The equations as they are printed, one cell and one direction at a time, on two lattices: slow,
/// and meant to be compared with.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "lbm_solver/solver/kernel.h"

namespace test {

using lbm::Domain;
using lbm::Vec2;

/// What covers a cell.
struct NaiveCover {
  double weight = 0.0;  ///< B, with a turbulence model the solid fraction; 0: pure fluid
  bool whole = false;   ///< covered whole
  bool core = false;    ///< deep inside
  Vec2 velocity{0.0, 0.0};
};

class NaiveLattice {
 public:
  using Cell = std::array<double, 9>;

  NaiveLattice(const Domain& domain, const lbm::KernelChoice& choice);

  Cell& cell(int x, int y) { return f_[y * domain_.nx + x]; }
  NaiveCover& cover(int x, int y) { return cover_[y * domain_.nx + x]; }
  /// Force on the solids in a cell over the last step: B G - B Σ c_i Ω_i^s, the full sum.
  Vec2 force(int x, int y) const { return force_[y * domain_.nx + x]; }

  /// Collides every cell, then moves populations one cell on or bounces them back half-way.
  void step();

 private:
  Cell collided(int x, int y);
  /// Post-collision populations of pure fluid.
  Cell fluid(const Cell& f) const;
  /// Relaxation time with the eddy viscosity.
  double tau(const Cell& f) const;
  Cell solid_term(const Cell& f, const Cell& eq_fluid, double rho, const NaiveCover& c) const;
  void stream(int x, int y, const Cell& f, std::vector<Cell>& next) const;

  Domain domain_;
  lbm::KernelChoice choice_;
  std::vector<Cell> f_;
  std::vector<NaiveCover> cover_;
  std::vector<Vec2> force_;
};

/// Second-order equilibrium of all directions (not shifted).
NaiveLattice::Cell naive_equilibrium(double rho, const Vec2& u);

}  // namespace test
