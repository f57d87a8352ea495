// SPDX-License-Identifier: GPL-2.0-or-later
#include <fmt/format.h>

#include <stdexcept>

#include "lbm_solver/solver/kernel_rows.h"

namespace lbm {
namespace {

const KernelRows& table() {
  static const KernelRows all = [] {
    KernelRows rows;
    for (const auto& part :
         {bgk_rows(), trt_rows(), central_moment_rows(), recursive_regularised_rows()})
      rows.insert(rows.end(), part.begin(), part.end());
    return rows;
  }();
  return all;
}

bool same(const KernelTableRow& a, const KernelTableRow& b) {
  return a.collision == b.collision && a.lattice == b.lattice && a.precision == b.precision &&
         a.local_viscosity == b.local_viscosity && a.force == b.force;
}

std::string text(const KernelTableRow& r) {
  return fmt::format("{} {} {} + {} + {}", r.lattice,
                     r.precision == Precision::Double ? "double" : "single", name_of(r.collision),
                     r.local_viscosity ? "local viscosity" : "constant viscosity",
                     r.force ? "force" : "no force");
}

}  // namespace

std::unique_ptr<Kernel> make_kernel(const KernelChoice& c) {
  const KernelTableRow wanted{.collision = c.collision,
                              .lattice = c.lattice,
                              .precision = c.precision,
                              .local_viscosity = c.local_viscosity(),
                              .force = c.force,
                              .make = nullptr};
  for (const KernelTableRow& row : table())
    if (same(row, wanted)) return row.make(c);
  std::string known;
  for (const KernelTableRow& row : table()) known += "\n  " + text(row);
  throw std::invalid_argument(fmt::format("no kernel for {}; known:{}", text(wanted), known));
}

}  // namespace lbm
