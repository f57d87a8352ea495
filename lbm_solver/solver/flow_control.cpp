// SPDX-License-Identifier: GPL-2.0-or-later
#include "lbm_solver/solver/flow_control.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "lbm_solver/solver/fluid.h"

namespace lbm {
namespace {

constexpr double kCrossings = 2.5;  // T over the cells along the axis, about 1.4 c_s T
constexpr std::int64_t kLooks = 10, kShortest = 5;
constexpr double kGrain = 0x1p-32;  // momenta are added up in whole numbers of it: in any order

/// Momentum along an axis of what has arrived in a row and has not come back from a wall that the
/// axis runs along, in grains.
std::int64_t row_momentum(const Fluid& fluid, int axis, int y, int z) {
  const Lattice& l = fluid.lattice();
  const Domain& box = fluid.domain();
  const Cell3 n = box.cells(), &begin = fluid.cells().begin;
  const auto bounced = [&](int q, const Cell3& at) {
    for (int k = 0; k < l.D; ++k) {
      const int from = at[k] - l.c[q][k];
      if (k != axis && (from < 0 || from >= n[k]) && box.sides()[k] == Side::Wall) return true;
    }
    return false;
  };
  std::int64_t sum = 0;
  for (int x = 0; x < fluid.cells().size[0]; ++x) {
    double momentum = 0.0;
    for (int q = 1; q < l.Q; ++q)
      if (l.c[q][axis] != 0 && !bounced(q, {x + begin[0], y + begin[1], z + begin[2]}))
        momentum += l.c[q][axis] * fluid.arriving(q, x, y, z);
    sum += std::llround(momentum / kGrain);
  }
  return sum;
}

}  // namespace

FlowControl::FlowControl(int axis, double mean_velocity, const InTime& in_time, int cells)
    : axis_(axis),
      target_(mean_velocity),
      in_time_(in_time),
      every_(std::max(kShortest, static_cast<std::int64_t>(kCrossings * cells) / kLooks)),
      time_(static_cast<double>(kLooks * every_)) {}

void FlowControl::adjust(std::int64_t step, double mean_velocity) {
  const double before = step == 0 ? mean_velocity : mean_;
  force_ += (before - mean_velocity) / static_cast<double>(every_) +
            (wanted(step) - mean_velocity) / time_;
  mean_ = mean_velocity;
}

Record FlowControl::save() const {
  Record record;
  record.set("force", force_);
  record.set("mean_velocity", mean_);
  return record;
}

void FlowControl::load(const Record& record) {
  force_ = record.real("force");
  mean_ = record.real("mean_velocity");
}

double mean_velocity(const Fluid& fluid, int axis) {
  const Cell3& n = fluid.cells().size;
  const Cell3 all = fluid.domain().cells();
  std::int64_t sum = 0;
#pragma omp parallel for reduction(+ : sum) schedule(static)
  for (int row = 0; row < n[1] * n[2]; ++row)
    sum += row_momentum(fluid, axis, row % n[1], row / n[1]);
  std::array<double, 1> total{static_cast<double>(sum) * kGrain};
  fluid.ranks().sum(total);
  return total[0] / (static_cast<double>(all[0]) * all[1] * all[2]);
}

}  // namespace lbm
