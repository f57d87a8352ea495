// SPDX-License-Identifier: GPL-2.0-or-later
#include "lbm_solver/collision/recursive_regularised.h"
#include "lbm_solver/solver/kernel_rows.h"

namespace lbm {

/// In double precision only: it is the slowest to compile, and central moments serve the same
/// flows.
template <class L, class Real>
KernelRows recursive_regularised_rows() {
  if constexpr (std::is_same_v<Real, double>)
    return rows_of<RecursiveRegularised, L, Real>(CollisionOperator::RecursiveRegularised);
  else
    return {};
}
template KernelRows recursive_regularised_rows<BPLBM_LATTICE, BPLBM_REAL>();

}  // namespace lbm
