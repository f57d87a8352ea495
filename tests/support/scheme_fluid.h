// SPDX-License-Identifier: GPL-2.0-or-later
/// A fluid at rest with one of the fluid-solid schemes, and the balance of its momentum.
#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "lbm_solver/immersed/resistance.h"
#include "lbm_solver/solver/fluid.h"

namespace test {

using namespace lbm;

/// A scheme of its own, or covered cells with a solid term.
struct Case {
  SolidScheme scheme = SolidScheme::ImmersedMovingBoundary;
  SolidTerm term = SolidTerm::None;

  Case(SolidScheme scheme) : scheme(scheme) {}
  Case(SolidTerm term) : term(term) {}
  bool covers() const { return scheme == SolidScheme::ImmersedMovingBoundary; }
  std::string name() const { return covers() ? name_of(term) : name_of(scheme); }
};

inline Fluid make(const Case& c, const Domain& domain, CollisionOperator collision, double tau,
                  const Vec3& force = Vec3()) {
  Fluid fluid(domain,
              {.collision = collision,
               .force = force.norm() > 0.0,
               .solid_term = c.term,
               .parameters = {.tau = tau,
                              .magic = by_resistance(c.term) ? kResistanceMagic : 3.0 / 16.0,
                              .force_x = force.x(),
                              .force_y = force.y()}});
  if (!c.covers()) fluid.use(make_scheme(c.scheme, domain, fluid.lattice()));
  for (int y = 0; y < domain.ny; ++y)
    for (int x = 0; x < domain.nx; ++x) fluid.set_equilibrium(x, y, 1.0, {0.0, 0.0});
  return fluid;
}

/// Momentum of a periodic fluid, without that of cells whose centres some discs cover.
inline Vec3 momentum(const Fluid& fluid, const std::vector<Body>& without = {}) {
  const Domain& d = fluid.domain();
  Vec3 sum(0.0, 0.0);
  for (int y = 0; y < d.ny; ++y)
    for (int x = 0; x < d.nx; ++x) {
      bool solid = false;
      for (const Body& disc : without) {
        Vec3 arm = Vec3(x + 0.5, y + 0.5) - disc.centre;
        arm.x() -= d.nx * std::round(arm.x() / d.nx);
        arm.y() -= d.ny * std::round(arm.y() / d.ny);
        solid = solid || arm.norm() < disc.radius;
      }
      for (int q = 1; q < D2Q9::Q && !solid; ++q)
        sum += fluid.arriving(q, x, y) * Vec3(D2Q9::c[q][0], D2Q9::c[q][1]);
    }
  return sum;
}

/// Where solids act by the links that cross their surface, the cells inside are none of the fluid.
inline bool acts_by_links(SolidScheme scheme) {
  return scheme == SolidScheme::BounceBack || scheme == SolidScheme::InterpolatedBounceBack;
}

/// A step of a periodic fluid with discs in it: what the fluid's change of momentum and the
/// impulses on the discs leave, over the latter where they are above 1.
class MomentumBalance {
 public:
  MomentumBalance(Fluid& fluid, SolidScheme scheme)
      : fluid_(fluid), links_(acts_by_links(scheme)) {}

  double step(const std::vector<Body>& discs) {
    const Vec3 before = momentum(fluid_, covered_);
    fluid_.place(discs);
    fluid_.step();
    if (links_) covered_ = discs;
    Vec3 on_discs(0.0, 0.0);
    for (const auto& load : fluid_.momentary_loads()) on_discs += load.force;
    return (momentum(fluid_, covered_) - before + on_discs).norm() / std::max(1.0, on_discs.norm());
  }

 private:
  Fluid& fluid_;
  bool links_;
  std::vector<Body> covered_;  // of the step before
};

/// A square array of cylinders in Stokes flow, c = 0.2, Re 0.1, in a fluid that a body force
/// drives.
struct SlowArray {
  static constexpr int n = 20;  // cells a period
  static constexpr double tau = 0.6, nu = (tau - 0.5) / 3.0;
  const double radius = n * std::sqrt(0.2 / std::numbers::pi);
  const double g = 51.53 * nu * (0.1 * nu / (2.0 * radius)) / (n * n);  ///< acceleration along x

  /// Drag over mu U of the array carried along with its fluid, `carried` cells a step.
  double drag(Fluid& fluid, double carried) const {
    constexpr int steps = 6000, last = 2000;  // the passage of whole cells
    for (int y = 0; y < n; ++y)
      for (int x = 0; x < n; ++x) fluid.set_equilibrium(x, y, 1.0, {carried, 0.0});
    Body disc{1, {0.5 * n, 0.5 * n + 0.23}, radius, {carried, 0.0}, 0.0};
    double relative = 0.0;
    for (int s = 0; s < steps; ++s) {
      fluid.place(std::vector{disc});
      fluid.step();
      disc.centre.x() = std::fmod(disc.centre.x() + carried, n);
      if (s >= steps - last && s % 10 == 0)
        for (int y = 0; y < n; ++y)
          for (int x = 0; x < n; ++x)
            relative += (fluid.cell(x, y).u.x() - carried) / (n * n * (last / 10.0));
    }
    return g * n * n / (nu * relative);
  }
};

inline void move(std::vector<Body>& discs) {
  for (Body& d : discs) d.centre += d.velocity;
}

}  // namespace test
