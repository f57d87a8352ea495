// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include "lbm_solver/solver/fluid.h"

namespace test {

/// Mean momentum of the cells of a box, lattice units: the flux of a steady flow.
inline lbm::Vec3 flux(const lbm::Fluid& fluid) {
  const lbm::Domain& d = fluid.domain();
  lbm::Vec3 sum = lbm::Vec3::Zero();
  for (int z = 0; z < d.nz; ++z)
    for (int y = 0; y < d.ny; ++y)
      for (int x = 0; x < d.nx; ++x) sum += fluid.arrived_momentum(x, y, z);
  return sum / (1.0 * d.nx * d.ny * d.nz);
}

}  // namespace test
