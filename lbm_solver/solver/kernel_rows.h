// SPDX-License-Identifier: GPL-2.0-or-later
/// How a source file kernel_*.cpp lists the kernels that it compiles.
#pragma once

#include "lbm_solver/collision/forcing.h"
#include "lbm_solver/solver/row_kernel.h"

namespace lbm {

struct KernelTableRow {
  std::string collision, lattice, turbulence;
  Precision precision;
  bool force, solids;
  std::unique_ptr<Kernel> (*make)(const KernelChoice&);
};
using KernelRows = std::vector<KernelTableRow>;

// One operator a file, so that they compile side by side.
KernelRows bgk_rows();
KernelRows trt_rows();
KernelRows central_moment_rows();
KernelRows recursive_regularised_rows();

template <class Collision, class Solids, class Real>
std::unique_ptr<Kernel> make_row_kernel(const KernelChoice& c) {
  return std::make_unique<RowKernel<Collision, Solids, Real>>(c);
}

/// The rows of one operator with one turbulence model and force.
template <class Collision, class Real>
void add_rows(KernelRows& rows, const char* name, const char* turbulence, bool force) {
  constexpr Precision precision =
      std::is_same_v<Real, double> ? Precision::Double : Precision::Single;
  const char* lattice = Collision::Set::name;
  rows.push_back({name, lattice, turbulence, precision, force, false,
                  make_row_kernel<Collision, NoSolids, Real>});
  rows.push_back({name, lattice, turbulence, precision, force, true,
                  make_row_kernel<Collision, CoveredCells, Real>});
}

/// All rows of one lattice and precision.
template <template <class, class, class> class Collision, class L, class Real>
void add_lattice(KernelRows& rows, const char* name) {
  add_rows<Collision<L, Laminar, NoForce<L>>, Real>(rows, name, "none", false);
  add_rows<Collision<L, Laminar, GuoForce<L>>, Real>(rows, name, "none", true);
  add_rows<Collision<L, Smagorinsky, NoForce<L>>, Real>(rows, name, "smagorinsky", false);
  add_rows<Collision<L, Smagorinsky, GuoForce<L>>, Real>(rows, name, "smagorinsky", true);
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
