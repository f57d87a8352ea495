// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>

#include "lbm_solver/base/vec3.h"
#include "lbm_solver/lattice/lattice.h"

namespace lbm {

/// Storage of one lattice: one padded array a direction (structure of arrays), each with a ghost
/// layer on every side (none in z in two dimensions). Stored are deviations from rest, f_i - w_i,
/// so that a fluid at rest is exactly zero and round-off is relative to the motion; single
/// precision owes its worth to that.
class Populations {
 public:
  /// @param cells  along x, y, z; in two dimensions z = 1
  Populations(const Lattice& lattice, const Cell3& cells, Precision precision = Precision::Double);

  const Lattice& lattice() const { return lattice_; }
  Precision precision() const { return precision_; }
  int nx() const { return cells_[0]; }
  int ny() const { return cells_[1]; }
  int nz() const { return cells_[2]; }
  const Cell3& cells() const { return cells_; }

  /// Start of row (y, z) of direction q; y = -1 … ny, z = -1 … nz, valid for x = -1 … nx. `Real` is
  /// the type that the precision names.
  template <class Real>
  Real* row(int q, int y, int z = 0) {
    return static_cast<Real*>(memory_.get()) + start(q, y, z);
  }
  template <class Real>
  const Real* row(int q, int y, int z = 0) const {
    return static_cast<const Real*>(memory_.get()) + start(q, y, z);
  }
  /// Numbers between two rows that are neighbours in y.
  std::ptrdiff_t stride() const { return stride_; }

  /// A value in either precision, by its number in memory.
  double get(std::ptrdiff_t at) const {
    return precision_ == Precision::Double ? static_cast<const double*>(memory_.get())[at]
                                           : static_cast<const float*>(memory_.get())[at];
  }
  void set(std::ptrdiff_t at, double value) {
    if (precision_ == Precision::Double)
      static_cast<double*>(memory_.get())[at] = value;
    else
      static_cast<float*>(memory_.get())[at] = static_cast<float>(value);
  }
  std::ptrdiff_t start(int q, int y, int z) const {
    return first_ + q * plane_ + ((z + ghost_z_) * (cells_[1] + 2) + y + 1) * stride_;
  }

  std::size_t bytes() const { return bytes_; }
  /// Too large for a core's share of the caches: huge pages and fetching ahead pay. Measured with
  /// D3Q19 on a core with the whole of 32 MB: fetching ahead gained 30 % from 33 MB on and lost 5 %
  /// up to 21 MB; other cores want their share.
  bool beyond_caches() const { return bytes_ >= kCacheShare; }

 private:
  static constexpr std::size_t kCacheShare = std::size_t{8} << 20;
  template <class Real>
  void touch();
  struct Free {
    void operator()(void* p) const;
  };
  const Lattice& lattice_;
  Cell3 cells_;
  Precision precision_;
  int ghost_z_;
  std::ptrdiff_t stride_, plane_, first_;
  std::size_t bytes_;
  std::unique_ptr<void, Free> memory_;
};

/// One stored population, whatever its precision.
class Population {
 public:
  Population(Populations& f, std::ptrdiff_t at) : f_(f), at_(at) {}
  operator double() const { return f_.get(at_); }  // NOLINT: stands for the number
  const Population& operator=(double value) const {
    f_.set(at_, value);
    return *this;
  }
  const Population& operator+=(double value) const { return *this = *this + value; }
  Population(const Population&) = default;
  const Population& operator=(const Population& other) const {
    return *this = static_cast<double>(other);
  }

 private:
  Populations& f_;
  std::ptrdiff_t at_;
};

}  // namespace lbm
