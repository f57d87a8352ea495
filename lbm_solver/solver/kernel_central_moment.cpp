// SPDX-License-Identifier: GPL-2.0-or-later
#include "lbm_solver/collision/central_moments.h"
#include "lbm_solver/solver/kernel_rows.h"

namespace lbm {

template <class L>
KernelRows central_moment_rows() {
  return rows_of<CentralMoments, L>(CollisionOperator::CentralMoment);
}
template KernelRows central_moment_rows<BPLBM_LATTICE>();

}  // namespace lbm
