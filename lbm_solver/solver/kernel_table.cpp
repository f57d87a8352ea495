// SPDX-License-Identifier: GPL-2.0-or-later
#include <fmt/core.h>

#include <stdexcept>

#include "lbm_solver/base/errors.h"
#include "lbm_solver/solver/kernel_rows.h"

namespace lbm {
namespace {

/// The kernels of a lattice L with populations of type Real.
template <class L, class Real>
struct Kernels {};

template <class... L, class... Real>
KernelRows all_rows(Kernels<L, Real>...) {
  KernelRows rows;
  const auto add = [&](const KernelRows& part) {
    rows.insert(rows.end(), part.begin(), part.end());
  };
  (add(bgk_rows<L, Real>()), ...);
  (add(trt_rows<L, Real>()), ...);
  (add(central_moment_rows<L, Real>()), ...);
  (add(recursive_regularised_rows<L, Real>()), ...);
  return rows;
}

/// Those that this program is built with (lbm_solver/CMakeLists.txt).
const KernelRows& table() {
  static const KernelRows all = all_rows(BPLBM_KERNELS);
  return all;
}

bool same(const KernelTableRow& a, const KernelTableRow& b) {
  return a.collision == b.collision && a.lattice == b.lattice && a.precision == b.precision &&
         a.local_viscosity == b.local_viscosity && a.force == b.force;
}

std::string text(const KernelTableRow& r) {
  return fmt::format(
      "{} {} {} + {} + {}", name_of(r.lattice), name_of(r.precision), name_of(r.collision),
      r.local_viscosity ? "local viscosity" : "constant viscosity", r.force ? "force" : "no force");
}

}  // namespace

std::unique_ptr<Kernel> make_kernel(const KernelChoice& c) {
  const KernelTableRow wanted{.collision = c.collision,
                              .lattice = c.lattice,
                              .precision = c.precision,
                              .local_viscosity = c.local_viscosity(),
                              .force = c.force,
                              .make = nullptr};
  bool built = false;
  for (const KernelTableRow& row : table()) {
    if (same(row, wanted)) return row.make(c);
    built |= row.lattice == wanted.lattice && row.precision == wanted.precision;
  }
  if (!built)
    throw InputError(fmt::format("this program was built without the lattice {} in {} precision",
                                 name_of(wanted.lattice), name_of(wanted.precision)),
                     "take lbm, which has all of them; tools/build makes it");
  std::string known;
  for (const KernelTableRow& row : table()) known += "\n  " + text(row);
  throw std::invalid_argument(fmt::format("no kernel for {}; known:{}", text(wanted), known));
}

}  // namespace lbm
