// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "lbm_solver/coupling/start_check.h"
#include "lbm_solver/solver/plan.h"
#include "protocol/wire/session.h"

namespace lbm {

/// Largest speeds that the guard has seen, the last ones.
class SpeedRecord {
 public:
  /// @param step   fluid steps since the start
  /// @param speed  lattice units; not finite where the state is not
  void add(std::int64_t step, double speed);

  /// Factor by which the speed grew in a step, from the look before the last one on; not there
  /// before the second look.
  std::optional<double> growth() const;
  std::int64_t steps_between() const;  ///< of the last two looks
  double before() const;               ///< speed at the look before the last one

 private:
  struct Look {
    std::int64_t step;
    double speed;
  };
  std::vector<Look> looks_;  // two at most
};

/// Why something moves too fast, and what to do about it, in sentences: which particles are near
/// and how deep they lie in others, in obstacles and in walls, whether the speed grew smoothly or
/// by a factor a step, and what in the scene drives.
/// @param time       [s], at which obstacles are where they are
/// @param at         where the fluid is too fast [m]; absent: it is a particle, the fastest one
/// @param particles  all of the box, or none
/// @param starts     of those that began deep in a solid
std::string diagnosis(const Scene& scene, const Plan& plan, double time,
                      const std::optional<Vec3>& at, const SpeedRecord& record,
                      const std::vector<protocol::Particle>& particles,
                      const DeepStarts& starts = {});

}  // namespace lbm
