// SPDX-License-Identifier: GPL-2.0-or-later
#include "lbm_solver/solver/flow_control.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <vector>

#include "lbm_solver/solver/fluid.h"

namespace lbm {
namespace {

constexpr double kCrossings = 2.5;  // T over the cells along the axis, about 1.4 c_s T
constexpr std::int64_t kLooks = 10, kShortest = 5;
constexpr int kLowBits = 32;  // of a sum, that go to the other ranks by themselves

/// Momentum along an axis of what has arrived in a row and has not come back from a wall that the
/// axis runs along, in grains.
std::int64_t row_momentum(const Fluid& fluid, int axis, double grain, int y, int z) {
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
    sum += std::llround(momentum / grain);
  }
  return sum;
}

}  // namespace

FlowControl::FlowControl(int axis, double mean_velocity, const InTime& in_time, int cells)
    : axis_(axis),
      target_(mean_velocity),
      in_time_(in_time),
      every_(look_every(cells)),
      time_(static_cast<double>(kLooks * every_)) {}

std::int64_t FlowControl::look_every(int cells) {
  return std::max(kShortest, static_cast<std::int64_t>(kCrossings * cells) / kLooks);
}

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

double momentum_grain(const Cell3& n) {
  const auto cells = static_cast<std::uint64_t>(n[0]) * static_cast<std::uint64_t>(n[1]) *
                     static_cast<std::uint64_t>(n[2]);
  return std::ldexp(1.0, static_cast<int>(std::bit_width(cells)) - 62);
}

double mean_velocity(const Fluid& fluid, int axis) {
  const Cell3& n = fluid.cells().size;
  const Cell3 all = fluid.domain().cells();
  const double grain = momentum_grain(all);
  std::int64_t sum = 0;
#pragma omp parallel for reduction(+ : sum) schedule(static)
  for (int row = 0; row < n[1] * n[2]; ++row)
    sum += row_momentum(fluid, axis, grain, row % n[1], row / n[1]);
  constexpr std::int64_t low = (std::int64_t{1} << kLowBits) - 1;
  std::array<double, 2> total{static_cast<double>(sum >> kLowBits), static_cast<double>(sum & low)};
  fluid.ranks().sum(total);  // whole numbers, below 2^53: exact
  const double grains = std::ldexp(total[0], kLowBits) + total[1];
  return grains * grain / (static_cast<double>(all[0]) * all[1] * all[2]);
}

}  // namespace lbm
