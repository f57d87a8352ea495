// SPDX-License-Identifier: MIT
#include "protocol/wire/ball_union.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>
#include <vector>

namespace protocol {
namespace {

/// Lines across the smallest ball, at most so many along an axis of all: errors of 3e-5.
struct Fineness {
  double lines, most;
};
constexpr Fineness kDiscs{800.0, 20000.0}, kBalls{160.0, 1000.0};

UnionMoments one_ball(const Ball& ball, bool flat, double depth) {
  const double r2 = ball.radius * ball.radius, disc = std::numbers::pi * r2;
  UnionMoments m{flat ? disc * depth : disc * ball.radius * 4.0 / 3.0, ball.x, {}};
  const double own = r2 * (flat ? 0.25 : 0.2);
  const auto& [x, y, z] = ball.x;
  m.second = {x * x + own, y * y + own, flat ? 0.0 : z * z + own, y * z, z * x, x * y};
  return m;
}

/// Sums over lines along x.
class Lines {
 public:
  void add(std::span<std::pair<double, double>> parts, double y, double z, double weight) {
    std::sort(parts.begin(), parts.end());
    double end = -std::numeric_limits<double>::infinity();
    for (const auto& [from, to] : parts) {
      const double begin = std::max(from, end);
      if (to <= begin) continue;
      add_part(begin, to, y, z, weight);
      end = to;
    }
  }
  UnionMoments mean() const {
    UnionMoments m{volume_, first_, second_};
    for (double& value : m.centroid) value /= volume_;
    for (double& value : m.second) value /= volume_;
    return m;
  }

 private:
  void add_part(double a, double b, double y, double z, double weight) {
    const double length = weight * (b - a), middle = 0.5 * (a + b);
    volume_ += length;
    first_[0] += length * middle;
    first_[1] += length * y;
    first_[2] += length * z;
    const double squares = (a * a + a * b + b * b) / 3.0;
    const double products[6] = {squares, y * y, z * z, y * z, z * middle, middle * y};
    for (int k = 0; k < 6; ++k) second_[k] += length * products[k];
  }
  double volume_ = 0.0;
  Vec3 first_{};
  std::array<double, 6> second_{};
};

/// Middles of `count` equal parts of [lo, hi].
struct Grid1 {
  double lo = 0.0, step = 1.0;
  int count = 1;
  Grid1(std::span<const Ball> balls, unsigned axis, double smallest, const Fineness& fine) {
    double hi = -std::numeric_limits<double>::infinity();
    lo = -hi;
    for (const Ball& b : balls) {
      lo = std::min(lo, b.x[axis] - b.radius);
      hi = std::max(hi, b.x[axis] + b.radius);
    }
    count =
        static_cast<int>(std::min(fine.most, std::ceil(fine.lines * (hi - lo) / (2.0 * smallest))));
    step = (hi - lo) / count;
  }
  Grid1() = default;
  double at(int i) const { return lo + (i + 0.5) * step; }
};

}  // namespace

UnionMoments moments_of_union(std::span<const Ball> balls, unsigned dimension, double depth) {
  const bool flat = dimension == 2;
  if (balls.size() == 1) return one_ball(balls.front(), flat, depth);
  double smallest = std::numeric_limits<double>::infinity();
  for (const Ball& b : balls) smallest = std::min(smallest, b.radius);
  const Fineness& fine = flat ? kDiscs : kBalls;
  const Grid1 along_y(balls, 1, smallest, fine);
  const Grid1 along_z = flat ? Grid1() : Grid1(balls, 2, smallest, fine);
  const double weight = along_y.step * (flat ? depth : along_z.step);
  Lines lines;
  std::vector<std::pair<double, double>> parts;
  for (int k = 0; k < along_z.count; ++k)
    for (int j = 0; j < along_y.count; ++j) {
      const double y = along_y.at(j), z = flat ? 0.0 : along_z.at(k);
      parts.clear();
      for (const Ball& b : balls) {
        const double dy = y - b.x[1], dz = flat ? 0.0 : z - b.x[2];
        const double rest = b.radius * b.radius - dy * dy - dz * dz;
        if (rest <= 0.0) continue;
        const double half = std::sqrt(rest);
        parts.emplace_back(b.x[0] - half, b.x[0] + half);
      }
      lines.add(parts, y, z, weight);
    }
  return lines.mean();
}

double bounding_radius(std::span<const Ball> balls) {
  double radius = 0.0;
  for (const Ball& b : balls)
    radius = std::max(radius, std::hypot(b.x[0], b.x[1], b.x[2]) + b.radius);
  return radius;
}

}  // namespace protocol
