// SPDX-License-Identifier: GPL-2.0-or-later
#include "lbm_solver/collision/two_rates.h"
#include "lbm_solver/solver/kernel_rows.h"

namespace lbm {

template <class L, class Viscosity, class Force>
using Trt = TwoRates<L, MagicRate, Viscosity, Force>;

template <class L, class Real>
KernelRows trt_rows() {
  return rows_of<Trt, L, Real>(CollisionOperator::Trt);
}
template KernelRows trt_rows<BPLBM_LATTICE, BPLBM_REAL>();

}  // namespace lbm
