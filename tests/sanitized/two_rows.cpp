// SPDX-License-Identifier: GPL-2.0-or-later
/// The kernel table with two rows, because sanitizers take a quarter of an hour for a whole
/// operator.
#include "lbm_solver/collision/two_rates.h"
#include "lbm_solver/solver/kernel_rows.h"

namespace lbm {

template <class L, class Viscosity, class Force>
using Trt = TwoRates<L, MagicRate, Viscosity, Force>;

template <class L, class Real>
KernelRows trt_rows() {
  KernelRows rows;
  add_row<Trt<L, ConstantViscosity, NoForce<L>>, double>(rows, CollisionOperator::Trt);
  return rows;
}
template <class L, class Real>
KernelRows bgk_rows() {
  return {};
}
template <class L, class Real>
KernelRows central_moment_rows() {
  return {};
}
template <class L, class Real>
KernelRows recursive_regularised_rows() {
  return {};
}

template KernelRows bgk_rows<D2Q9, double>();
template KernelRows bgk_rows<D3Q19, double>();
template KernelRows trt_rows<D2Q9, double>();
template KernelRows trt_rows<D3Q19, double>();
template KernelRows central_moment_rows<D2Q9, double>();
template KernelRows central_moment_rows<D3Q19, double>();
template KernelRows recursive_regularised_rows<D2Q9, double>();
template KernelRows recursive_regularised_rows<D3Q19, double>();

}  // namespace lbm
