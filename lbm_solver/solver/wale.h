// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "lbm_solver/base/record.h"
#include "lbm_solver/field/decomposition.h"
#include "lbm_solver/viscosity/eddy_field.h"

namespace lbm {

class Fluid;

/// Wall-adapting eddy viscosity [NicoudDucros1999]: Smagorinsky's times
///   κ = 10.6 OP/|S|,   OP = D^{3/2}/(s^{5/2} + D^{5/4}),   s = S_ab S_ab,   D = S^d_ab S^d_ab,
/// with S^d the symmetric part of g², g = ∂u_a/∂x_b, without its trace. It vanishes in plane shear
/// and as the cube of the distance from a wall, whatever its shape and its motion. 10.6 gives the
/// same dissipation in isotropic turbulence.
///
/// g needs neighbours: κ is found by central differences between cells (beside walls one-sided) of
/// the velocity that rows show, every kEvery steps. In a vortex that turns as a solid body |S| is 0
/// and OP is not: κ is at most 10.6.
class Wale {
 public:
  static constexpr std::int64_t kEvery = 8;

  explicit Wale(const Decomposition& ranks);

  bool due(std::int64_t step) const { return step % kEvery == 0; }
  /// Steps from one step to the next look.
  std::int64_t until_next(std::int64_t step) const { return kEvery - step % kEvery; }
  /// From the present velocities. Collective.
  void update(Fluid& fluid);
  const EddyField& field() const { return field_; }

  Record save() const;
  /// @throws std::invalid_argument  the record is of another box
  void load(const Record& record);

 private:
  std::size_t at(int x, int y, int z) const {
    return (static_cast<std::size_t>(z + 1) * (n_[1] + 2) + y + 1) * (n_[0] + 2) + x + 1;
  }
  void take_velocities(Fluid& fluid);
  void fill_beyond(int axis);
  double factor(int x, int y, int z) const;

  const Decomposition& ranks_;
  Cell3 n_;  // cells of the rank
  int dimension_;
  EddyField field_;
  std::array<std::vector<float>, 3> u_;  // with a layer of cells around
};

}  // namespace lbm
