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

std::string text(const KernelTableRow& r) {
  return fmt::format("{} {} {} + {} + {}", r.lattice,
                     r.precision == Precision::Double ? "double" : "single", r.collision,
                     r.turbulence == "none" ? "laminar" : r.turbulence,
                     r.force ? "force" : "no force");
}

}  // namespace

std::unique_ptr<Kernel> make_kernel(const KernelChoice& c) {
  const KernelTableRow wanted{c.collision, c.lattice, c.turbulence, c.precision, c.force, nullptr};
  std::string known;
  for (const KernelTableRow& row : table()) {
    if (text(row) == text(wanted)) return row.make(c);
    known += "\n  " + text(row);
  }
  throw std::invalid_argument(fmt::format("no kernel for {}; known:{}", text(wanted), known));
}

std::vector<std::string> known_collisions() {
  return {"bgk", "trt", "central_moment", "recursive_regularised"};
}

}  // namespace lbm
