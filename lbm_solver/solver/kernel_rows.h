// SPDX-License-Identifier: GPL-2.0-or-later
/// How a source file kernel_*.cpp lists the kernels that it compiles: those of one operator on the
/// lattice BPLBM_LATTICE with populations of type BPLBM_REAL, once for each lattice and precision
/// of lbm_solver/CMakeLists.txt. So they compile side by side, and a first run in the plane need
/// not wait for those in space or in single precision.
#pragma once

#include "lbm_solver/collision/forcing.h"
#include "lbm_solver/solver/row_kernel.h"
#include "lbm_solver/viscosity/constant_viscosity.h"
#include "lbm_solver/viscosity/local_viscosity.h"

namespace lbm {

struct KernelTableRow {
  CollisionOperator collision;
  VelocitySet lattice;
  Precision precision;
  bool local_viscosity, force;
  std::unique_ptr<Kernel> (*make)(const KernelChoice&);
};
using KernelRows = std::vector<KernelTableRow>;

template <class L, class Real>
KernelRows bgk_rows();
template <class L, class Real>
KernelRows trt_rows();
template <class L, class Real>
KernelRows central_moment_rows();
template <class L, class Real>
KernelRows recursive_regularised_rows();

template <class Collision, class Real>
std::unique_ptr<Kernel> make_row_kernel(const KernelChoice& c) {
  return std::make_unique<RowKernel<Collision, Real>>(c);
}

template <class Collision, class Real>
void add_row(KernelRows& rows, CollisionOperator collision) {
  rows.push_back({.collision = collision,
                  .lattice = Collision::Set::id,
                  .precision = std::is_same_v<Real, double> ? Precision::Double : Precision::Single,
                  .local_viscosity = Collision::local_viscosity,
                  .force = Collision::forced,
                  .make = make_row_kernel<Collision, Real>});
}

/// All rows of one lattice and precision of an operator that is a template on lattice, viscosity
/// and force: every law of viscosity that is not constant shares one.
template <template <class, class, class> class Collision, class L, class Real>
KernelRows rows_of(CollisionOperator collision) {
  KernelRows rows;
  add_row<Collision<L, ConstantViscosity, NoForce<L>>, Real>(rows, collision);
  add_row<Collision<L, ConstantViscosity, GuoForce<L>>, Real>(rows, collision);
  add_row<Collision<L, LocalViscosity, NoForce<L>>, Real>(rows, collision);
  add_row<Collision<L, LocalViscosity, GuoForce<L>>, Real>(rows, collision);
  return rows;
}

}  // namespace lbm
