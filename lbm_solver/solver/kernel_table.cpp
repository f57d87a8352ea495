// SPDX-License-Identifier: GPL-2.0-or-later
/// The combinations that are compiled. To add one: write its policy, add a row here, add it to the
/// reference test in tests/unit/lbm_solver/kernel_test.cpp.
#include <fmt/format.h>

#include <stdexcept>

#include "lbm_solver/solver/row_kernel.h"

namespace lbm {
namespace {

Rates bgk(const KernelChoice& c) {
  return Rates::bgk(c.tau);
}
Rates trt(const KernelChoice& c) {
  return Rates::trt(c.tau, c.magic);
}

template <class Term>
std::unique_ptr<Kernel> two_rates(const Rates& rates) {
  return std::make_unique<RowKernel<TwoRates, Term>>(rates);
}

struct TableRow {
  const char* collision;
  const char* solid_term;
  Rates (*rates)(const KernelChoice&);
  std::unique_ptr<Kernel> (*make)(const Rates&);
};

// BGK is TRT with equal rates: the same compiled kernel.
constexpr TableRow kTable[] = {
    {"bgk", "none", bgk, two_rates<NoSolid>},
    {"bgk", "noble_torczynski", bgk, two_rates<NobleTorczynski>},
    {"bgk", "holdych", bgk, two_rates<Holdych>},
    {"bgk", "layered_holdych", bgk, two_rates<LayeredHoldych>},
    {"trt", "none", trt, two_rates<NoSolid>},
    {"trt", "noble_torczynski", trt, two_rates<NobleTorczynski>},
    {"trt", "holdych", trt, two_rates<Holdych>},
    {"trt", "layered_holdych", trt, two_rates<LayeredHoldych>},
};

}  // namespace

std::unique_ptr<Kernel> make_kernel(const KernelChoice& choice) {
  std::string known;
  for (const TableRow& row : kTable) {
    if (choice.collision == row.collision && choice.solid_term == row.solid_term)
      return row.make(row.rates(choice));
    known += fmt::format("\n  {} + {}", row.collision, row.solid_term);
  }
  throw std::invalid_argument(
      fmt::format("no kernel for collision '{}' with solid term '{}'; known:{}", choice.collision,
                  choice.solid_term, known));
}

std::vector<std::string> known_collisions() {
  return {"bgk", "trt"};
}
std::vector<std::string> known_solid_terms() {
  return {"noble_torczynski", "holdych", "layered_holdych"};
}

}  // namespace lbm
