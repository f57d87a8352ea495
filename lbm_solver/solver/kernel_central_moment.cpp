// SPDX-License-Identifier: GPL-2.0-or-later
#include "lbm_solver/collision/central_moments.h"
#include "lbm_solver/solver/kernel_rows.h"

namespace lbm {

template <class L, class Real>
KernelRows central_moment_rows() {
  return rows_of<CentralMoments, L, Real>(CollisionOperator::CentralMoment);
}
template KernelRows central_moment_rows<BPLBM_LATTICE, BPLBM_REAL>();

}  // namespace lbm
