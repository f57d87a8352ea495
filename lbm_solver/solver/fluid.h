// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "lbm_solver/boundary/patch.h"
#include "lbm_solver/immersed/body_scheme.h"
#include "lbm_solver/solver/kernel.h"

namespace lbm {

/// The fluid: a lattice, what happens at its sides, and the solids in it. Everything in lattice
/// units.
class Fluid {
 public:
  /// Starts at rest with density 1.
  Fluid(const Domain& domain, const KernelChoice& choice);

  const Domain& domain() const { return domain_; }
  bool has_solids() const { return cover_ || scheme_; }
  const CoverMap* cover() const { return cover_.get(); }

  /// Sets a cell to the equilibrium of a density and a velocity.
  void set_equilibrium(int x, int y, double rho, const Vec2& u);

  /// Adds a boundary on a part of a side; patches act in the order in which they were added.
  void add(std::unique_ptr<Patch> patch) { patches_.push_back(std::move(patch)); }
  const std::vector<std::unique_ptr<Patch>>& patches() const { return patches_; }
  /// Cells [x0, x1) × [y0, y1) become a wall at rest. Needs a solid term in the kernel's choice.
  void add_wall(int x0, int y0, int x1, int y1) { cover_->add_wall(x0, y0, x1, y1); }

  /// Solids act by a scheme of its own instead of covered cells (which walls keep).
  void use(std::unique_ptr<BodyScheme> scheme) { scheme_ = std::move(scheme); }
  /// To be called after the last wall was added.
  void prepare_walls() {
    if (cover_) cover_->update({});
  }
  /// Places the solids for the next step. Needs a scheme, or a solid term in the kernel's choice.
  void place(std::span<const Disc> discs);

  /// Advances by one time step, or by some, in one parallel region, between which nothing is placed
  /// or asked for.
  void step() { advance(1); }
  void advance(std::int64_t steps);
  std::int64_t steps() const { return steps_; }

  /// Loads on the placed discs over the last step, in their order.
  std::vector<DiscLoad> loads() const { return scheme_ ? scheme_->loads() : cover_->loads(); }
  /// Part of a cell that solids cover, at most 1.
  double solid_fraction(int x, int y) const;

  struct Cell {
    double rho;
    Vec2 u;
  };
  /// Density and velocity of the populations that have arrived at a cell.
  Cell cell(int x, int y) const;
  /// The same at any place in lattice units, between the centres of the four nearest cells
  /// (bilinear).
  Cell at(const Vec2& place) const;

  /// Population f_q - w_q that has arrived at a cell, for tests and cell passes.
  double& arriving(int q, int x, int y) { return stream_.arriving(f_, q, x, y); }
  double arriving(int q, int x, int y) const { return stream_.arriving(f_, q, x, y); }

  struct Extremes {
    double max_speed = 0.0;
    int x = 0, y = 0;  ///< cell of max_speed, or the first cell that is not finite
    bool finite = true;
    double mass_excess = 0.0;  ///< Σ (rho - 1)
  };
  Extremes extremes();

  /// Density and velocity of a whole row. @param rho, ux, uy  [nx] each, overwritten
  void row(int y, std::span<double> rho, std::span<double> ux, std::span<double> uy);

  /// Everything that the coming steps depend on, as named arrays; obstacles and boundaries must be
  /// in place again before `restore`. @throws std::invalid_argument where the state is of another
  /// fluid
  std::map<std::string, std::vector<double>> state() const;
  void restore(const std::map<std::string, std::vector<double>>& state);

  std::size_t bytes() const { return f_.bytes() + (cover_ ? cover_->bytes() : 0); }

 private:
  Domain domain_;
  Populations f_;
  EsotericPull stream_;
  std::unique_ptr<Kernel> kernel_;
  Vec2 half_force_;  // half the body force: rho u = Σ c f + F/2
  std::unique_ptr<CoverMap> cover_;
  std::unique_ptr<BodyScheme> scheme_;
  std::vector<Disc> discs_;  // of scheme_
  std::vector<std::unique_ptr<Patch>> patches_;
  std::int64_t steps_ = 0;
};

}  // namespace lbm
