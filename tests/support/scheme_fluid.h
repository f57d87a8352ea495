// SPDX-License-Identifier: GPL-2.0-or-later
/// A fluid at rest with one of the fluid-solid schemes.
#pragma once

#include <string>

#include "lbm_solver/solver/fluid.h"

namespace test {

using namespace lbm;

/// A scheme of its own, or covered cells with a solid term.
struct Case {
  std::string scheme, term;
  std::string name() const { return scheme.empty() ? term : scheme; }
};

inline Fluid make(const Case& c, const Domain& domain, const std::string& collision, double tau,
                  const Vec3& force = Vec3()) {
  Fluid fluid(domain, {collision,
                       "none",
                       force.norm() > 0.0,
                       c.term,
                       {.tau = tau, .force_x = force.x(), .force_y = force.y()}});
  if (!c.scheme.empty()) fluid.use(make_scheme(c.scheme, domain, fluid.lattice(), {0.5 * force}));
  for (int y = 0; y < domain.ny; ++y)
    for (int x = 0; x < domain.nx; ++x) fluid.set_equilibrium(x, y, 1.0, {0.0, 0.0});
  return fluid;
}

}  // namespace test
