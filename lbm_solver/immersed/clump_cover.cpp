// SPDX-License-Identifier: GPL-2.0-or-later
#include "lbm_solver/immersed/clump_cover.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include "lbm_solver/immersed/solid_fraction.h"

namespace lbm {
namespace {

/// Those at which sphere_fraction and disc_fraction measure: a sphere that is there twice is taken
/// out to round-off.
constexpr std::array kPoints{-kGaussPoint, kGaussPoint};

using Part = std::pair<double, double>;

/// Where a line along an axis through a cell lies in a ball; empty: first >= second.
Part in_ball(const Vec3& centre, int axis, double radius) {
  const double across2 = centre.squaredNorm() - centre[axis] * centre[axis];
  const double rest = radius * radius - across2;
  if (rest <= 0.0) return {0.0, 0.0};
  const double half = std::sqrt(rest);
  return {std::max(-0.5, -centre[axis] - half), std::min(0.5, -centre[axis] + half)};
}

/// A ball that may touch a cell: from its centre to that of the cell.
struct Ball {
  Vec3 arm;
  double radius;
};

/// Part of a line of the cell that lies in `own` and in any of the others.
double shared_length(const Ball& own, std::span<const Ball> others, const Vec3& off, int axis,
                     std::vector<Part>& parts) {
  const Part mine = in_ball(own.arm + off, axis, own.radius);
  if (mine.first >= mine.second) return 0.0;
  parts.clear();
  for (const Ball& other : others) {
    const Part theirs = in_ball(other.arm + off, axis, other.radius);
    const Part both{std::max(mine.first, theirs.first), std::min(mine.second, theirs.second)};
    if (both.first < both.second) parts.push_back(both);
  }
  std::ranges::sort(parts);
  double length = 0.0, end = -1.0;
  for (const auto& [from, to] : parts) {
    length += std::max(0.0, to - std::max(from, end));
    end = std::max(end, to);
  }
  return length;
}

/// Part of a unit cell that lies in `own` and in any of the others.
double shared_fraction(const Ball& own, std::span<const Ball> others, bool flat,
                       std::vector<Part>& parts) {
  int axis = 0;
  for (int a = 1; a < (flat ? 2 : 3); ++a)
    if (std::abs(own.arm[a]) > std::abs(own.arm[axis])) axis = a;
  const int p = (axis + 1) % (flat ? 2 : 3), q = (axis + 2) % 3;
  double sum = 0.0;
  for (const double i : kPoints) {
    Vec3 off;
    off[p] = i;
    if (flat) {
      sum += shared_length(own, others, off, axis, parts);
      continue;
    }
    for (const double j : kPoints) {
      off[q] = j;
      sum += shared_length(own, others, off, axis, parts);
    }
  }
  return sum / (flat ? 2.0 : 4.0);
}

Vec3 snapped(const Vec3& centre) {
  return Vec3((centre / kSnap).array().round().matrix() * kSnap);
}

}  // namespace

void take_union(Footprint& footprint, const Body& sphere, std::span<const Body> others,
                const Domain& domain) {
  constexpr double half_diagonal = 0.8661;
  const bool flat = domain.dimension() == 2;
  const Vec3 centre = snapped(sphere.centre);
  std::vector<Ball> near, here;
  for (const Body& other : others) {
    const Vec3 apart = domain.nearest_image(centre - snapped(other.centre));
    if (apart.norm() < sphere.radius + other.radius + 2.0 * half_diagonal)
      near.push_back({apart, other.radius});
  }
  if (near.empty()) return;
  std::vector<Part> parts;
  for (CoverBlock& block : footprint.blocks())
    for (int lane = 0; lane < kPackWidth; ++lane) {
      double& cover = block.cover[lane];
      if (cover <= 0.0 || cover >= kWhole) continue;
      const Vec3 arm(block.arm[0] + lane, block.arm[1], flat ? 0.0 : block.arm[2]);
      here.clear();
      for (const Ball& ball : near)
        if ((arm + ball.arm).norm() < ball.radius + half_diagonal)
          here.push_back({arm + ball.arm, ball.radius});
      if (here.empty()) continue;
      const double shared = shared_fraction({arm, sphere.radius}, here, flat, parts);
      cover = std::max(0.0, cover - shared);
    }
}

}  // namespace lbm
