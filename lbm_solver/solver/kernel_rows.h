// SPDX-License-Identifier: GPL-2.0-or-later
/// How a source file kernel_*.cpp lists the kernels that it compiles.
#pragma once

#include "lbm_solver/collision/forcing.h"
#include "lbm_solver/solver/row_kernel.h"

namespace lbm {

struct KernelTableRow {
  std::string collision, turbulence;
  bool force, solids;
  std::unique_ptr<Kernel> (*make)(const KernelChoice&);
};
using KernelRows = std::vector<KernelTableRow>;

// One operator a file, so that they compile side by side.
KernelRows bgk_rows();
KernelRows trt_rows();
KernelRows central_moment_rows();
KernelRows recursive_regularised_rows();

template <class Collision, class Solids>
std::unique_ptr<Kernel> make_row_kernel(const KernelChoice& c) {
  return std::make_unique<RowKernel<Collision, Solids>>(c);
}

/// The rows of one operator with one turbulence model and force.
template <class Collision>
void add_rows(KernelRows& rows, const char* name, const char* turbulence, bool force) {
  rows.push_back({name, turbulence, force, false, make_row_kernel<Collision, NoSolids>});
  rows.push_back({name, turbulence, force, true, make_row_kernel<Collision, CoveredCells>});
}

/// All rows of an operator that is a template on turbulence model and force.
template <template <class, class> class Collision>
KernelRows rows_of(const char* name) {
  KernelRows rows;
  add_rows<Collision<Laminar, NoForce>>(rows, name, "none", false);
  add_rows<Collision<Laminar, GuoForce>>(rows, name, "none", true);
  add_rows<Collision<Smagorinsky, NoForce>>(rows, name, "smagorinsky", false);
  add_rows<Collision<Smagorinsky, GuoForce>>(rows, name, "smagorinsky", true);
  return rows;
}

}  // namespace lbm
