// SPDX-License-Identifier: GPL-2.0-or-later
/// The kernel table with two rows, because sanitizers take a quarter of an hour for a whole
/// operator.
#include "lbm_solver/collision/two_rates.h"
#include "lbm_solver/solver/kernel_rows.h"

namespace lbm {

template <class L, class Viscosity, class Force>
using Trt = TwoRates<L, MagicRate, Viscosity, Force>;

KernelRows trt_rows() {
  KernelRows rows;
  add_row<Trt<D2Q9, ConstantViscosity, NoForce<D2Q9>>, double>(rows, CollisionOperator::Trt);
  add_row<Trt<D3Q19, ConstantViscosity, NoForce<D3Q19>>, double>(rows, CollisionOperator::Trt);
  return rows;
}
KernelRows bgk_rows() {
  return {};
}
KernelRows central_moment_rows() {
  return {};
}
KernelRows recursive_regularised_rows() {
  return {};
}

}  // namespace lbm
