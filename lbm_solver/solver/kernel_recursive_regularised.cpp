// SPDX-License-Identifier: GPL-2.0-or-later
#include "lbm_solver/collision/recursive_regularised.h"
#include "lbm_solver/solver/kernel_rows.h"

namespace lbm {

KernelRows recursive_regularised_rows() {
  return rows_of<RecursiveRegularised>("recursive_regularised");
}

}  // namespace lbm
