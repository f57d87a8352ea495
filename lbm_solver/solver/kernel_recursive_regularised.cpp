// SPDX-License-Identifier: GPL-2.0-or-later
#include "lbm_solver/collision/recursive_regularised.h"
#include "lbm_solver/solver/kernel_rows.h"

namespace lbm {

/// In double precision only: it is the slowest to compile, and central moments serve the same
/// flows.
template <class L>
KernelRows recursive_regularised_rows() {
  KernelRows rows;
  add_precision<RecursiveRegularised, L, double>(rows, CollisionOperator::RecursiveRegularised);
  return rows;
}
template KernelRows recursive_regularised_rows<BPLBM_LATTICE>();

}  // namespace lbm
