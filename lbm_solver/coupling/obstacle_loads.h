// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "lbm_solver/base/record.h"
#include "lbm_solver/coupling/inner_fluid.h"
#include "lbm_solver/immersed/body.h"
#include "lbm_solver/io/probe_writer.h"
#include "lbm_solver/solver/plan.h"

namespace lbm {

/// Writes the mean loads on the scene's obstacles since the line before to `obstacles.csv`, in SI
/// units: a line for each obstacle by its number in the scene, from 1, and one numbered 0 for the
/// sum over the grains of a file. The torque on a block is about its centre, that on what moves
/// about the pivot of its motion, which is its middle where the scene names none.
class ObstacleLoads {
 public:
  /// @param keep_until  a run that goes on keeps the lines before this time
  ObstacleLoads(const Scene& scene, const Plan& plan, const Decomposition& ranks,
                const std::string& folder, double keep_until);

  /// After each fluid step. @param bodies  this rank's loads in the order of obstacle_bodies
  void add(Fluid& fluid, std::span<const BodyLoad> bodies);
  /// Collective.
  void write(double time);

  /// Collective; the same on every rank, and what `load` wants on every rank.
  Record save() const;
  /// @throws std::invalid_argument where it is of other obstacles
  void load(const Record& record);
  /// See Observers.
  void move_to(const Decomposition& ranks) {
    ranks_ = ranks;
    blocks_.reset();
  }

 private:
  std::vector<BodyLoad> whole() const;
  Vec3 arm_of(std::size_t body, std::int64_t step) const;

  const Units units_;
  Decomposition ranks_;
  std::optional<CsvWriter> table_;  // of rank 0
  std::vector<int> line_;           // [round obstacle]: into sums_
  std::vector<int> block_line_;     // [block]: into sums_
  std::vector<int> shape_line_;     // [mesh or image]: into sums_
  struct Mover {
    int line;  // into sums_
    InnerFluid inner;
  };
  std::vector<Mover> movers_;                        // where they count: of the first rank
  std::vector<std::optional<MotionScene>> motions_;  // [round obstacle]
  std::vector<Vec3> centres_;                        // [round obstacle] at rest, in cells
  const std::vector<CellBox> boxes_;
  std::optional<BlockLoads> blocks_;  // from the first step on
  std::vector<BodyLoad> sums_;        // since the last line, of this rank; 0: grains
  bool has_grains_ = false;
  int steps_ = 0;
};

}  // namespace lbm
