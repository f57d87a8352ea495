// SPDX-License-Identifier: GPL-2.0-or-later
#include "lbm_solver/collision/central_moments.h"
#include "lbm_solver/solver/kernel_rows.h"

namespace lbm {

KernelRows central_moment_rows() {
  return rows_of<CentralMoments>(CollisionOperator::CentralMoment);
}

}  // namespace lbm
