// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <array>
#include <cstddef>
#include <memory>
#include <span>

#include "lbm_solver/lattice/d2q9.h"

namespace lbm {

/// What a pair of opposite sides of the box does to populations that leave through it.
enum class Side { Periodic, Wall };

/// Storage of one lattice: one padded array a direction (structure of arrays), each with a ghost
/// row below and above and a ghost column behind. Stored are deviations from rest, f_i - w_i, so
/// that a fluid at rest is exactly zero and round-off is relative to the motion.
class Populations {
 public:
  /// @param nx, ny  cells
  Populations(int nx, int ny);

  int nx() const { return nx_; }
  int ny() const { return ny_; }

  /// Start of row y (-1 … ny) of direction q; valid for x = -1 … nx.
  double* row(int q, int y) { return first_ + q * plane_ + (y + 1) * stride_; }
  const double* row(int q, int y) const { return first_ + q * plane_ + (y + 1) * stride_; }

  /// The whole memory, padding included: two fields of the same extent have the same layout.
  std::span<double> raw() { return {memory_.get(), size_}; }
  std::span<const double> raw() const { return {memory_.get(), size_}; }

  std::size_t bytes() const { return size_ * sizeof(double); }

 private:
  struct Free {
    void operator()(double* p) const;
  };
  int nx_, ny_;
  std::ptrdiff_t stride_, plane_;
  std::size_t size_;
  std::unique_ptr<double[], Free> memory_;
  double* first_;
};

}  // namespace lbm
