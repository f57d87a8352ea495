// SPDX-License-Identifier: GPL-2.0-or-later
#include "lbm_solver/immersed/footprint.h"

#include <algorithm>
#include <cmath>

#include "lbm_solver/immersed/disc_fraction.h"

namespace lbm {
namespace {

/// Fractions within one row are all 0 beyond `outer` and all 1 within `inner` (half diagonal 0.71).
constexpr double kHalfDiagonal = 0.7072;

/// First image of coordinate `at` that may touch [0, n], and how many images do.
struct Images {
  double first;
  int count;
};
Images images(double at, double radius, int n, Side side) {
  if (side == Side::Wall) return {at, 1};
  const double lowest = at - std::floor((at + radius) / n) * n;  // in [-radius, n - radius)
  return {lowest, lowest + n - radius < n ? 2 : 1};
}

}  // namespace

bool Footprint::update(const Disc& disc, const Domain& domain) {
  const Vec2 centre = (disc.centre / kSnap).array().round() * kSnap;
  if (centre == centre_ && disc.radius == radius_ && disc.hollow == hollow_) return false;
  centre_ = centre;
  radius_ = disc.radius;
  hollow_ = disc.hollow;
  spans_.clear();
  fractions_.clear();
  if (disc.hollow) {
    add_outside(centre, disc.radius, domain);
    return true;
  }
  const Images x = images(centre.x(), disc.radius, domain.nx, domain.x);
  const Images y = images(centre.y(), disc.radius, domain.ny, domain.y);
  for (int j = 0; j < y.count; ++j)
    for (int i = 0; i < x.count; ++i)
      add_image({x.first + i * domain.nx, y.first + j * domain.ny}, disc.radius, domain);
  return true;
}

/// All cells, with what the circle leaves of them; no images.
void Footprint::add_outside(const Vec2& centre, double radius, const Domain& domain) {
  const int blocks = (domain.nx + kPackWidth - 1) / kPackWidth;
  const Pack core(radius + kCoreDepth), full(radius + kHalfDiagonal);
  for (int y = 0; y < domain.ny; ++y) {
    const double dy = y + 0.5 - centre.y();
    for (int k = 0; k < blocks; ++k) {
      const double first_arm = k * kPackWidth + 0.5 - centre.x();
      const Pack dx = Pack(first_arm) + lane_numbers(), distance2 = dx * dx + Pack(dy * dy);
      Pack fraction = Pack(1.0) - disc_fraction(dx, Pack(dy), radius);
      where(distance2 > full * full, fraction) = Pack(1.0);
      where(Pack(k * kPackWidth) + lane_numbers() >= Pack(domain.nx), fraction) = Pack(0.0);
      if (all_of(fraction == Pack(0.0))) continue;
      const int eps = static_cast<int>(fractions_.size());
      fractions_.resize(fractions_.size() + kPackWidth);
      store(&fractions_[eps], fraction);
      const bool deep = all_of(distance2 > core * core);
      spans_.push_back({y, k, 1, eps, 0, deep ? kPackWidth : 0, first_arm, dy});
    }
  }
}

void Footprint::add_image(const Vec2& centre, double radius, const Domain& domain) {
  const auto clip = [](double v, int n) {
    return static_cast<int>(std::clamp(v, 0.0, static_cast<double>(n)));
  };
  const double inner = std::max(0.0, radius - kHalfDiagonal);
  const double core = std::max(0.0, radius - kCoreDepth);
  const int y_begin = clip(std::floor(centre.y() - radius), domain.ny);
  const int y_end = clip(std::ceil(centre.y() + radius), domain.ny);
  for (int y = y_begin; y < y_end; ++y) {
    const double dy = y + 0.5 - centre.y();
    const double near = std::max(0.0, std::abs(dy) - 0.5);  // closest approach of the row
    const double half = std::sqrt(std::max(0.0, radius * radius - near * near));
    const int x_begin = clip(std::floor(centre.x() - half), domain.nx);
    const int x_end = clip(std::ceil(centre.x() + half), domain.nx);
    if (x_begin >= x_end) continue;
    const int block = x_begin / kPackWidth, blocks = (x_end - 1) / kPackWidth - block + 1;
    const int first = block * kPackWidth;
    const double first_arm = first + 0.5 - centre.x();
    const double core2 = core * core - dy * dy, half_core = core2 > 0.0 ? std::sqrt(core2) : 0.0;
    const auto clip_core = [&](double arm) {
      return std::clamp(static_cast<int>(std::ceil(arm - first_arm)), x_begin - first,
                        x_end - first);
    };
    const int eps = static_cast<int>(fractions_.size());
    spans_.push_back(
        {y, block, blocks, eps, clip_core(-half_core), clip_core(half_core), first_arm, dy});
    fractions_.resize(fractions_.size() + static_cast<std::size_t>(blocks) * kPackWidth);
    const Pack full2(inner * inner - dy * dy);
    for (int k = 0; k < blocks; ++k) {
      const Pack dx = Pack(first_arm + k * kPackWidth) + lane_numbers();
      Pack fraction = disc_fraction(dx, Pack(dy), radius);
      where(dx * dx < full2, fraction) = Pack(1.0);
      store(&fractions_[eps + k * kPackWidth], fraction);
    }
    std::fill(fractions_.begin() + eps + std::min(blocks * kPackWidth, domain.nx - first),
              fractions_.end(), 0.0);  // no cells beyond the end of the row
  }
}

}  // namespace lbm
