// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "lbm_solver/immersed/body_scheme.h"

namespace lbm {

/// Where a link sees the wall.
enum class WallPlace {
  HalfWay,       ///< in the middle of every cut link: a staircase
  Interpolated,  ///< where the link cuts the surface
};

/// Bounce-back on the links that cross a surface [Ladd1994], interpolated [Bouzidi2001]. A link
/// leads from a solid cell to a fluid cell along q and is cut at the part δ of its length from the
/// fluid cell. With f* the populations after collision:
///   half-way        f_q(x) = f_-q*(x) + 6 w_q c_q·u_w
///   δ < ½           f_q(x) = 2δ f_-q*(x) + (1 - 2δ) f_-q*(x + c_q) + 6 w_q c_q·u_w
///   δ ≥ ½           f_q(x) = (f_-q*(x) + 6 w_q c_q·u_w)/2δ + (1 - 1/2δ) f_q*(x)
/// Force on the solid: -c_q (f_-q* + f_q) a link, so that momentum is exchanged exactly. A cell
/// that is covered gives its momentum to the solid; one that is uncovered gets the equilibrium of
/// the solid's velocity and its neighbours' density, and its momentum from the solid
/// [AidunLuDing1998]. Mass is not conserved there.
class LinkedBodies final : public BodyScheme {
 public:
  LinkedBodies(const Domain& domain, const Lattice& lattice, WallPlace place);

  void before_sweep(std::span<const Body> bodies, Populations& f,
                    const EsotericPull& stream) override;
  void after_sweep(Populations& f, const EsotericPull& stream) override;
  std::vector<BodyLoad> loads() const override { return loads_; }

 private:
  struct Link {
    Cell3 cell;  ///< of fluid
    int q;       ///< direction from the solid to it
    Cell3 solid;
    int body;
    double delta;
    Vec3 arm;  ///< from the body's centre to the cut
  };
  using Owners = std::vector<std::int32_t>;  // [cell] body that holds the cell's centre, or -1

  Owners find_owners() const;
  void find_links();
  void change_cells(const Owners& before, Populations& f, const EsotericPull& stream);
  double incoming(const Link& link, const Populations& f, const EsotericPull& stream) const;
  /// Brings a cell back through periodic sides; false beyond a wall.
  bool inside(Cell3& cell) const;
  Cell3 beside(const Cell3& cell, int q) const;
  std::size_t index(const Cell3& c) const {
    return (static_cast<std::size_t>(c[2]) * domain_.ny + c[1]) * domain_.nx + c[0];
  }
  template <class F>
  void each_cell(F&& f) const;
  /// Shortest vector from the body's centre, or an image of it, to a cell's centre.
  Vec3 arm(const Body& body, const Cell3& cell) const;

  Domain domain_;
  const Lattice& lattice_;
  WallPlace place_;
  std::vector<Body> bodies_;
  std::vector<std::int64_t> ids_before_;
  Owners owners_;
  std::vector<Link> links_;
  std::vector<double> arriving_;  // [link]
  std::vector<BodyLoad> loads_;
};

}  // namespace lbm
