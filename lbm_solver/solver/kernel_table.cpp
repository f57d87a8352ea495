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

std::string text(const std::string& collision, const std::string& turbulence, bool force,
                 bool solids) {
  return fmt::format("{} + {} + {} + {}", collision, turbulence == "none" ? "laminar" : turbulence,
                     force ? "force" : "no force", solids ? "solids" : "no solids");
}

}  // namespace

std::unique_ptr<Kernel> make_kernel(const KernelChoice& c) {
  const bool solids = c.solid_term != "none";
  std::string known;
  for (const KernelTableRow& row : table()) {
    if (c.collision == row.collision && c.turbulence == row.turbulence && c.force == row.force &&
        solids == row.solids)
      return row.make(c);
    known += "\n  " + text(row.collision, row.turbulence, row.force, row.solids);
  }
  throw std::invalid_argument(fmt::format("no kernel for {}; known:{}",
                                          text(c.collision, c.turbulence, c.force, solids), known));
}

std::vector<std::string> known_collisions() {
  return {"bgk", "trt", "central_moment", "recursive_regularised"};
}

}  // namespace lbm
