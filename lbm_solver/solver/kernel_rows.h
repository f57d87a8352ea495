// SPDX-License-Identifier: GPL-2.0-or-later
/// How a source file kernel_*.cpp lists the kernels that it compiles.
#pragma once

#include "lbm_solver/collision/forcing.h"
#include "lbm_solver/solver/row_kernel.h"

namespace lbm {

struct KernelTableRow {
  std::string collision, lattice, turbulence;
  Precision precision;
  bool force;
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

/// The row of one operator with one turbulence model and force.
template <class Collision, class Real>
void add_row(KernelRows& rows, const char* name, const char* turbulence, bool force) {
  constexpr Precision precision =
      std::is_same_v<Real, double> ? Precision::Double : Precision::Single;
  rows.push_back(
      {name, Collision::Set::name, turbulence, precision, force, make_row_kernel<Collision, Real>});
}

/// All rows of one lattice and precision.
template <template <class, class, class> class Collision, class L, class Real>
void add_lattice(KernelRows& rows, const char* name) {
  add_row<Collision<L, Laminar, NoForce<L>>, Real>(rows, name, "none", false);
  add_row<Collision<L, Laminar, GuoForce<L>>, Real>(rows, name, "none", true);
  add_row<Collision<L, Smagorinsky, NoForce<L>>, Real>(rows, name, "smagorinsky", false);
  add_row<Collision<L, Smagorinsky, GuoForce<L>>, Real>(rows, name, "smagorinsky", true);
}

/// All rows of an operator that is a template on lattice, turbulence model and force.
template <template <class, class, class> class Collision>
KernelRows rows_of(const char* name) {
  KernelRows rows;
  add_lattice<Collision, D2Q9, double>(rows, name);
  add_lattice<Collision, D2Q9, float>(rows, name);
  add_lattice<Collision, D3Q19, double>(rows, name);
  add_lattice<Collision, D3Q19, float>(rows, name);
  add_lattice<Collision, D3Q27, double>(rows, name);
  add_lattice<Collision, D3Q27, float>(rows, name);
  return rows;
}

}  // namespace lbm
