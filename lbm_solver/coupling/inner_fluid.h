// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <cstdint>

#include "lbm_solver/base/mass_moments.h"
#include "lbm_solver/immersed/body.h"
#include "lbm_solver/solver/plan.h"

namespace lbm {

/// The fluid in the cells that an obstacle covers moves with it, and what that takes is part of the
/// load that the cells tell. The load on the obstacle's surface is without it.
class InnerFluid {
 public:
  /// @param obstacle  one that moves; of a hollow one nothing is taken off
  InnerFluid(const Plan& plan, const ObstacleScene& obstacle);

  /// What moves the inner fluid in a step, about the pivot, lattice units: to be added to a load.
  BodyLoad in_step(std::int64_t step) const;

 private:
  /// Momentum, and angular momentum about the pivot.
  BodyLoad momentum(const Pose& pose) const;

  Units units_;
  MotionScene motion_;
  MassMoments moments_;  // at rest, about the pivot
};

}  // namespace lbm
