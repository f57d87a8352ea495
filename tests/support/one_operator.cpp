// SPDX-License-Identifier: GPL-2.0-or-later
/// In place of the whole kernel table: one operator, so that it compiles with sanitizers in
/// minutes.
#include "lbm_solver/collision/two_rates.h"
#include "lbm_solver/solver/kernel_rows.h"

namespace lbm {
namespace {

template <class L, class Force>
using Trt = TwoRates<L, MagicRate, Laminar, Force>;

}  // namespace

KernelRows trt_rows() {
  KernelRows rows;
  add_row<Trt<D2Q9, NoForce<D2Q9>>, double>(rows, "trt", "none", false);
  add_row<Trt<D2Q9, GuoForce<D2Q9>>, double>(rows, "trt", "none", true);
  add_row<Trt<D3Q19, NoForce<D3Q19>>, double>(rows, "trt", "none", false);
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
