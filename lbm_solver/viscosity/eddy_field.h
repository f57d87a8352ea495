// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <span>
#include <vector>

#include "lbm_solver/base/vec3.h"

namespace lbm {

/// A number for each cell by which Smagorinsky's eddy viscosity is multiplied there,
///   nu_t = κ (S_c h)² |S|.
/// What sets κ is a model of turbulence near walls; without a field κ = 1.
class EddyField {
 public:
  explicit EddyField(const Cell3& cells)
      : cells_(cells), values_(static_cast<std::size_t>(cells[0]) * cells[1] * cells[2], 1.0f) {}

  const float* row(int y, int z) const { return &values_[start(y, z)]; }
  float* row(int y, int z) { return &values_[start(y, z)]; }
  std::span<float> values() { return values_; }
  std::span<const float> values() const { return values_; }
  std::size_t bytes() const { return values_.size() * sizeof(float); }

 private:
  std::size_t start(int y, int z) const {
    return (static_cast<std::size_t>(z) * cells_[1] + y) * cells_[0];
  }

  Cell3 cells_;
  std::vector<float> values_;  // [z][y][x]
};

}  // namespace lbm
