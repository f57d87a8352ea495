// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "lbm_solver/solver/plan.h"

namespace lbm {

/// Says when blocks of equal work are to be cut anew: where ranks have waited for the busiest one
/// longer than the scene wants, where the layers' work says that other cuts would help, and where
/// what was lost by waiting since the last move is more than that move took (docs/parallel.md).
class BlockBalance {
 public:
  BlockBalance(const Scene& scene, const Plan& plan, const Decomposition& ranks);

  bool due(std::int64_t interval) const { return on_ && interval % every_ == 0; }
  /// After an interval, where it is due. All ranks decide alike. Collective.
  /// @param worked  seconds that this rank has worked in its steps so far
  /// @return  the blocks to go on with, where they shall be others
  std::optional<Decomposition> look(double worked, const Fluid& fluid);

  /// The move that was asked for is done. Collective. @return  what the log says of it
  std::string moved(double seconds, const Decomposition& ranks);
  int moves() const { return moves_; }

 private:
  bool on_;
  double bound_;        // share of the busiest rank's time that the others may wait in the mean
  std::int64_t every_;  // intervals between two looks
  double worked_before_ = 0.0, lost_ = 0.0, cost_ = 0.0;  // [s]
  double waiting_ = 0.0, before_ = 1.0, after_ = 1.0;     // of the last move that was asked for
  int moves_ = 0;
};

}  // namespace lbm
