// SPDX-License-Identifier: GPL-2.0-or-later
#include "liggghts_coupling/host/covered_side.h"

#include <algorithm>

namespace dem {
namespace {

constexpr int kLines = 17;                      // along each axis of a side in three dimensions
constexpr int kFlatLines = 127;                 // of a side in two
constexpr double kOffset[] = {0.4871, 0.3819};  // of their distance: not where meshes have edges
constexpr double kEdge = 1e-9;  // of a triangle: a line between two that share an edge meets both

}  // namespace

CoveredSide::CoveredSide(const Place& lo, const Place& hi, int dimension, int side, double depth,
                         double beyond)
    : axis_(side / 2), first_(axis_ == 0 ? 1 : 0), second_(axis_ == 2 ? 1 : 2) {
  const bool low = side % 2 == 0;
  from_ = low ? lo[axis_] - beyond : hi[axis_] - depth;
  to_ = low ? lo[axis_] + depth : hi[axis_] + beyond;
  const int along = dimension == 3 ? kLines : kFlatLines, across = dimension == 3 ? kLines : 1;
  const auto place = [&](int k, int i, int n, double offset) {
    return lo[k] + (i + offset) / n * (hi[k] - lo[k]);
  };
  for (int j = 0; j < across; ++j)
    for (int i = 0; i < along; ++i)
      lines_.push_back(
          {place(first_, i, along, kOffset[0]), place(second_, j, across, kOffset[1])});
  met_.assign(lines_.size(), 0);
}

void CoveredSide::add(const std::array<Place, 3>& t) {
  const auto& [a, b, c] = t;
  const auto part = [&](const Place& p, const Place& q, double x, double y) {  // twice an area
    return (p[first_] - x) * (q[second_] - y) - (q[first_] - x) * (p[second_] - y);
  };
  const auto [low, high] = std::minmax({a[axis_], b[axis_], c[axis_]});
  if (high < from_ || low > to_) return;
  for (std::size_t i = 0; i < lines_.size(); ++i) {
    const auto [x, y] = lines_[i];
    const double of_a = part(b, c, x, y), of_b = part(c, a, x, y), of_c = part(a, b, x, y);
    const double whole = of_a + of_b + of_c;
    if (whole == 0.0 || std::min({of_a / whole, of_b / whole, of_c / whole}) < -kEdge) continue;
    const double at = (of_a * a[axis_] + of_b * b[axis_] + of_c * c[axis_]) / whole;
    if (at >= from_ && at <= to_) met_[i] = 1;
  }
}

bool CoveredSide::covered() const {
  return std::ranges::all_of(met_, [](int met) { return met != 0; });
}

}  // namespace dem
