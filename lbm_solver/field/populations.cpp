// SPDX-License-Identifier: GPL-2.0-or-later
#include "lbm_solver/field/populations.h"

#include <fmt/core.h>
#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>

#include "lbm_solver/base/errors.h"

namespace lbm {
namespace {

constexpr std::size_t kPage = 4096, kHugePage = std::size_t{2} << 20;
constexpr std::ptrdiff_t kLineBytes = 64;

std::ptrdiff_t round_up(std::ptrdiff_t n, std::ptrdiff_t to) {
  return (n + to - 1) / to * to;
}

/// Bytes of memory of this machine.
double machine_memory() {
  return static_cast<double>(sysconf(_SC_PHYS_PAGES)) * static_cast<double>(sysconf(_SC_PAGESIZE));
}

}  // namespace

void Populations::Free::operator()(void* p) const {
  std::free(p);
}

Populations::Populations(const Lattice& lattice, const Cell3& cells, Precision precision)
    : lattice_(lattice), cells_(cells), precision_(precision), ghost_z_(lattice.D == 3 ? 1 : 0) {
  const auto size =
      static_cast<std::ptrdiff_t>(precision == Precision::Double ? sizeof(double) : sizeof(float));
  const std::ptrdiff_t line = kLineBytes / size, page = kPage / size;
  stride_ = round_up(nx() + 2, line);  // x = -1 of a row lies in the padding of the row before
  // An odd number of cache lines between directions keeps their streams off the same cache sets.
  plane_ = round_up(stride_ * (ny() + 2) * (nz() + 2 * ghost_z_), page) + 9 * line;
  first_ = line;
  bytes_ = static_cast<std::size_t>(round_up(first_ + plane_ * lattice_.Q, page) * size);
  const bool huge = beyond_caches();
  const std::size_t alignment = huge ? kHugePage : kPage;
  bytes_ = (bytes_ + alignment - 1) / alignment * alignment;
  const auto bytes = static_cast<double>(bytes_);
  if (bytes < machine_memory()) memory_.reset(std::aligned_alloc(alignment, bytes_));
  if (!memory_)
    throw InputError(fmt::format("the lattice of {} × {} × {} cells needs {:.3g} GB, this machine "
                                 "has {:.3g}",
                                 nx(), ny(), nz(), 1e-9 * bytes, 1e-9 * machine_memory()),
                     "take larger cells, single precision, or ranks on more machines");
#ifdef MADV_HUGEPAGE
  if (huge) madvise(memory_.get(), bytes_, MADV_HUGEPAGE);
#endif
  if (precision_ == Precision::Double)
    touch<double>();
  else
    touch<float>();
}

/// First touch by the thread that will sweep the row.
template <class Real>
void Populations::touch() {
  const int layers = nz() + 2 * ghost_z_, rows = layers * (ny() + 2);
#pragma omp parallel for schedule(static)
  for (int r = 0; r < rows; ++r)
    for (int q = 0; q < lattice_.Q; ++q)
      std::fill_n(row<Real>(q, r % (ny() + 2) - 1, r / (ny() + 2) - ghost_z_), stride_, Real(0));
  // What lies between and behind the arrays is never read, and zero all the same.
  Real* const begin = static_cast<Real*>(memory_.get());
  Real* const end = begin + bytes_ / sizeof(Real);
  std::fill(begin, begin + first_, Real(0));
  for (int q = 0; q < lattice_.Q; ++q)
    std::fill(row<Real>(q, ny(), nz() - 1 + ghost_z_) + stride_,
              q + 1 < lattice_.Q ? row<Real>(q + 1, -1, -ghost_z_) : end, Real(0));
}

}  // namespace lbm
