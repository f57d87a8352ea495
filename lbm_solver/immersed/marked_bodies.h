// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <Eigen/Cholesky>
#include <map>
#include <vector>

#include "lbm_solver/immersed/body_scheme.h"

namespace lbm {

/// Immersed boundaries: a surface is a row of markers, and the no-slip condition is a force on the
/// fluid around them, spread with a smooth kernel D of four cells [Peskin2002]. Per marker k at X_k
/// with surface element s,
///   u(X_k) = Σ_x u(x) D(x - X_k),   δu(x) = Σ_k δu_k D(x - X_k) s.
/// The force acts on the populations that have arrived, as a shift by the difference of two
/// equilibria [Kupershtokh2004]; u there is the velocity with half of the force, as in Guo's
/// scheme. The fluid inside a body moves like the rest, so that its inertia is part of the load, as
/// with covered cells. In two dimensions only.
class MarkedBodies : public BodyScheme {
 public:
  explicit MarkedBodies(const Domain& domain) : domain_(domain) {}

  void before_sweep(std::span<const Body> bodies, Populations& f,
                    const EsotericPull& stream) override;
  std::vector<BodyLoad> loads() const override { return loads_; }

 protected:
  /// One cell in reach of a marker.
  struct Reach {
    std::int32_t cell;
    double weight;  ///< D
  };
  struct Marker {
    Vec3 arm;  ///< from the disc's centre
    std::vector<Reach> reach;
  };
  /// A disc and its markers where it is now.
  struct Marked {
    Body body;
    double element = 0.0;  ///< length of surface of a marker
    std::vector<Marker> markers;
  };

  /// Change of velocity that each marker asks for, twice the half of the force: [marker].
  virtual std::vector<Vec3> changes(const Marked& marked, const std::vector<Vec3>& slip) = 0;
  /// A body has new places for its markers.
  virtual void moved(const Marked&) {}

 private:
  void mark(Marked& marked) const;
  void add_reach(Marker& marker, const Vec3& place) const;
  Vec3 velocity(std::int32_t cell, const Populations& f, const EsotericPull& stream) const;
  void shift(std::int32_t cell, const Vec3& change, Populations& f,
             const EsotericPull& stream) const;

  Domain domain_;
  std::vector<Marked> marked_;
  std::vector<BodyLoad> loads_;
};

/// Implicit velocity correction [WuShu2009], the comparator of paper A: the δu_k are such that the
/// corrected velocity is the wall's at every marker,
///   Σ_j A_kj δu_j = U_k - u*(X_k),   A_kj = s Σ_x D(x - X_k) D(x - X_j).
/// Each body for itself: where two come nearer than four cells, both force the fluid between them.
class ImplicitMarkers final : public MarkedBodies {
 public:
  using MarkedBodies::MarkedBodies;

 private:
  std::vector<Vec3> changes(const Marked& marked, const std::vector<Vec3>& slip) override;
  void moved(const Marked& marked) override;
  std::map<std::int64_t, Eigen::LDLT<Eigen::MatrixXd>> systems_;  // by disc id
};

/// Springs of stiffness κ between markers that move with the fluid and their places on the body,
/// paper A Eqs 31-32: force on the fluid -κ ξ an element, dξ/dt = u - U.
class SpringMarkers final : public MarkedBodies {
 public:
  /// @param stiffness  κ, force a surface element and stretch, lattice units
  SpringMarkers(const Domain& domain, double stiffness)
      : MarkedBodies(domain), stiffness_(stiffness) {}
  std::vector<double> memory() const override;
  void restore(const std::vector<double>& memory) override;

 private:
  std::vector<Vec3> changes(const Marked& marked, const std::vector<Vec3>& slip) override;
  double stiffness_;
  std::map<std::int64_t, std::vector<Vec3>> stretch_;  // by disc id
};

}  // namespace lbm
