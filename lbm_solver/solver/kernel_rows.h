// SPDX-License-Identifier: GPL-2.0-or-later
/// How a source file kernel_*.cpp lists the kernels that it compiles.
#pragma once

#include "lbm_solver/collision/forcing.h"
#include "lbm_solver/solver/row_kernel.h"
#include "lbm_solver/viscosity/constant_viscosity.h"
#include "lbm_solver/viscosity/local_viscosity.h"

namespace lbm {

struct KernelTableRow {
  CollisionOperator collision;
  std::string lattice;
  Precision precision;
  bool local_viscosity, force;
  std::unique_ptr<Kernel> (*make)(const KernelChoice&);
};
using KernelRows = std::vector<KernelTableRow>;

// One operator a file, so that they compile side by side.
KernelRows bgk_rows();
KernelRows trt_rows();
KernelRows central_moment_rows();
KernelRows recursive_regularised_rows();

template <class Collision, class Real>
std::unique_ptr<Kernel> make_row_kernel(const KernelChoice& c) {
  return std::make_unique<RowKernel<Collision, Real>>(c);
}

template <class Collision, class Real>
void add_row(KernelRows& rows, CollisionOperator collision) {
  rows.push_back({.collision = collision,
                  .lattice = Collision::Set::name,
                  .precision = std::is_same_v<Real, double> ? Precision::Double : Precision::Single,
                  .local_viscosity = Collision::local_viscosity,
                  .force = Collision::forced,
                  .make = make_row_kernel<Collision, Real>});
}

/// All rows of one lattice and precision: every law of viscosity that is not constant shares one.
template <template <class, class, class> class Collision, class L, class Real>
void add_lattice(KernelRows& rows, CollisionOperator collision) {
  add_row<Collision<L, ConstantViscosity, NoForce<L>>, Real>(rows, collision);
  add_row<Collision<L, ConstantViscosity, GuoForce<L>>, Real>(rows, collision);
  add_row<Collision<L, LocalViscosity, NoForce<L>>, Real>(rows, collision);
  add_row<Collision<L, LocalViscosity, GuoForce<L>>, Real>(rows, collision);
}

/// All rows of an operator that is a template on lattice, viscosity and force.
template <template <class, class, class> class Collision>
KernelRows rows_of(CollisionOperator collision) {
  KernelRows rows;
  add_lattice<Collision, D2Q9, double>(rows, collision);
  add_lattice<Collision, D2Q9, float>(rows, collision);
  add_lattice<Collision, D3Q19, double>(rows, collision);
  add_lattice<Collision, D3Q19, float>(rows, collision);
  add_lattice<Collision, D3Q27, double>(rows, collision);
  add_lattice<Collision, D3Q27, float>(rows, collision);
  return rows;
}

}  // namespace lbm
