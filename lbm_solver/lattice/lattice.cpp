// SPDX-License-Identifier: GPL-2.0-or-later
#include "lbm_solver/lattice/lattice.h"

#include <stdexcept>

namespace lbm {
namespace {

constexpr Lattice kLattices[] = {to_lattice<D2Q9>(), to_lattice<D3Q19>(), to_lattice<D3Q27>()};

}  // namespace

const Lattice& lattice(const std::string& name) {
  for (const Lattice& l : kLattices)
    if (name == l.name) return l;
  throw std::invalid_argument("no lattice '" + name + "'; known: D2Q9 D3Q19 D3Q27");
}

std::vector<std::string> known_lattices() {
  return {D2Q9::name, D3Q19::name, D3Q27::name};
}

}  // namespace lbm
