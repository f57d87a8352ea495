// SPDX-License-Identifier: GPL-2.0-or-later
#include "lbm_solver/collision/two_rates.h"
#include "lbm_solver/solver/kernel_rows.h"

namespace lbm {

template <class L, class Viscosity, class Force>
using Bgk = TwoRates<L, EqualRates, Viscosity, Force>;

template <class L, class Real>
KernelRows bgk_rows() {
  return rows_of<Bgk, L, Real>(CollisionOperator::Bgk);
}
template KernelRows bgk_rows<BPLBM_LATTICE, BPLBM_REAL>();

}  // namespace lbm
