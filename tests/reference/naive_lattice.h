// SPDX-License-Identifier: GPL-2.0-or-later
/// The equations as they are printed, one cell and one direction at a time, on two lattices: slow,
/// and meant to be compared with.
#pragma once

#include <Eigen/Dense>
#include <array>
#include <string>
#include <vector>

#include "lbm_solver/solver/kernel.h"

namespace test {

using lbm::Domain;
using lbm::Vec3;

/// What covers a cell.
struct NaiveCover {
  double eps = 0.0;    ///< solid fraction; 0: pure fluid
  bool whole = false;  ///< covered whole
  bool core = false;   ///< deep inside
  bool wall = false;   ///< of a wall or block at rest
  Vec3 velocity;
};

class NaiveLattice {
 public:
  using Cell = std::array<double, 27>;  // of which a lattice uses its Q
  using Matrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor, 27, 27>;
  using Vector = Eigen::Matrix<double, Eigen::Dynamic, 1, Eigen::ColMajor, 27, 1>;

  NaiveLattice(const Domain& domain, const lbm::KernelChoice& choice);

  const lbm::Lattice& lattice() const { return l_; }
  Cell& cell(int x, int y, int z = 0) { return f_[index(x, y, z)]; }
  NaiveCover& cover(int x, int y, int z = 0) { return cover_[index(x, y, z)]; }
  /// Factor of the eddy viscosity in a cell.
  double& eddies(int x, int y, int z = 0) { return eddies_[index(x, y, z)]; }
  /// Force on the solids in a cell over the last step: B G - B Σ c_i Ω_i^s, the full sum.
  Vec3 force(int x, int y, int z = 0) const { return force_[index(x, y, z)]; }

  /// Collides every cell, then moves populations one cell on or bounces them back half-way.
  void step();

  /// Second-order equilibrium of all directions (not shifted).
  Cell equilibrium(double rho, const Vec3& u) const;

 private:
  struct Macroscopic {
    double rho = 0.0;
    Vec3 j;
  };
  std::size_t index(int x, int y, int z) const {
    return (static_cast<std::size_t>(z) * domain_.ny + y) * domain_.nx + x;
  }
  Vec3 c(int i) const;
  Macroscopic macroscopic(const Cell& f) const;
  Vec3 body_force() const;
  Cell source(const Vec3& u) const;
  Eigen::Matrix3d stress(const Cell& f, const Cell& eq, const Vec3& u) const;
  Cell central_moments(const Cell& f, double rho, const Vec3& u, double omega) const;
  Cell recursive_regularised(double rho, const Vec3& u, const Eigen::Matrix3d& q, const Cell& force,
                             double omega) const;
  Cell collided(std::size_t cell);
  /// Post-collision populations of pure fluid.
  Cell fluid(const Cell& f, double eddies) const;
  /// Relaxation time of the local viscosity. @param part  of the cell that is fluid, for a table
  double tau(const Cell& f, double eddies, double part = 1.0) const;
  Cell resistance(std::size_t cell);
  Cell solid_term(const Cell& f, const Cell& eq_fluid, double rho, const NaiveCover& c) const;

  Domain domain_;
  lbm::KernelChoice choice_;
  const lbm::Lattice& l_;
  std::vector<std::array<int, 3>> powers_;  // of the moments that the lattice has
  Matrix from_hermite_;                     // populations from moments of Hermite polynomials
  Matrix from_moments_;                     // and from those of monomials
  std::vector<Cell> f_;
  std::vector<NaiveCover> cover_;
  std::vector<Vec3> force_;
  std::vector<double> eddies_;
};

}  // namespace test
