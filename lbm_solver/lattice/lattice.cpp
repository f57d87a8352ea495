// SPDX-License-Identifier: GPL-2.0-or-later
#include "lbm_solver/lattice/lattice.h"

#include <stdexcept>

namespace lbm {
namespace {

constexpr Lattice kLattices[] = {to_lattice<D2Q9>(), to_lattice<D3Q19>(), to_lattice<D3Q27>()};

}  // namespace

const Lattice& lattice(const std::string& name) {
  std::string known;
  for (const Lattice& l : kLattices) {
    if (name == l.name) return l;
    known += std::string(" ") + l.name;
  }
  throw std::invalid_argument("no lattice '" + name + "'; known:" + known);
}

std::vector<std::string> known_lattices() {
  std::vector<std::string> names;
  for (const Lattice& l : kLattices) names.emplace_back(l.name);
  return names;
}

}  // namespace lbm
