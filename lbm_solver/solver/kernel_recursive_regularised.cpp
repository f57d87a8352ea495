// SPDX-License-Identifier: GPL-2.0-or-later
#include "lbm_solver/collision/recursive_regularised.h"
#include "lbm_solver/solver/kernel_rows.h"

namespace lbm {

/// In double precision only: it is the slowest to compile, and central moments serve the same
/// flows.
KernelRows recursive_regularised_rows() {
  constexpr CollisionOperator collision = CollisionOperator::RecursiveRegularised;
  KernelRows rows;
  add_lattice<RecursiveRegularised, D2Q9, double>(rows, collision);
  add_lattice<RecursiveRegularised, D3Q19, double>(rows, collision);
  add_lattice<RecursiveRegularised, D3Q27, double>(rows, collision);
  return rows;
}

}  // namespace lbm
