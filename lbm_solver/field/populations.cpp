// SPDX-License-Identifier: GPL-2.0-or-later
#include "lbm_solver/field/populations.h"

#include <algorithm>
#include <cstdlib>
#include <new>

namespace lbm {
namespace {

constexpr std::ptrdiff_t kLine = 8;  // doubles a cache line
constexpr std::size_t kAlignment = 4096;

std::ptrdiff_t round_up(std::ptrdiff_t n, std::ptrdiff_t to) {
  return (n + to - 1) / to * to;
}

}  // namespace

void Populations::Free::operator()(double* p) const {
  std::free(p);
}

Populations::Populations(int nx, int ny) : nx_(nx), ny_(ny) {
  stride_ = round_up(nx + 2, kLine);  // x = -1 of a row lies in the padding of the row before
  // An odd number of cache lines between directions keeps nine streams off the same cache sets.
  plane_ = round_up(stride_ * (ny + 2), 512) + 9 * kLine;
  const std::ptrdiff_t lead = kLine;
  size_ = static_cast<std::size_t>(round_up(lead + plane_ * D2Q9::Q, 512));
  memory_.reset(static_cast<double*>(std::aligned_alloc(kAlignment, size_ * sizeof(double))));
  if (!memory_) throw std::bad_alloc();
  first_ = memory_.get() + lead;
  // First touch by the thread that will sweep the row; the gaps too, for checkpoints keep them.
  std::fill_n(memory_.get(), lead, 0.0);
  double* const end = memory_.get() + size_;
  for (int q = 0; q < D2Q9::Q; ++q)
    std::fill(row(q, ny) + stride_, q + 1 < D2Q9::Q ? row(q + 1, -1) : end, 0.0);
#pragma omp parallel for schedule(static)
  for (int y = -1; y <= ny; ++y)
    for (int q = 0; q < D2Q9::Q; ++q) std::fill_n(row(q, y), stride_, 0.0);
}

}  // namespace lbm
