// SPDX-License-Identifier: GPL-2.0-or-later
#include "lbm_solver/lattice/lattice.h"

#include <algorithm>

namespace lbm {
namespace {

constexpr Lattice kLattices[] = {to_lattice<D2Q9>(), to_lattice<D3Q19>(), to_lattice<D3Q27>()};

}  // namespace

const Lattice& lattice(VelocitySet id) {
  return *std::ranges::find(kLattices, id, &Lattice::id);
}

}  // namespace lbm
