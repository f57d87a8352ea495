// SPDX-License-Identifier: GPL-2.0-or-later
#include "lbm_solver/coupling/lubrication.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

namespace lbm {
namespace {

constexpr double kRoughness =
    1e-3;  // smallest gap over R*: the force of a true contact is the solid's

/// An image of a disc, so that neighbours across periodic sides are found by position alone.
struct Image {
  std::size_t disc;
  Vec2 centre;
};

std::vector<Image> images(std::span<const Disc> discs, const Domain& domain, double reach) {
  std::vector<Image> all;
  const auto shifts = [&](double at, int n, Side side) {
    std::vector<double> s{0.0};
    if (side == Side::Periodic) {
      const double inside = at - std::floor(at / n) * n;
      s[0] = inside - at;
      if (inside < reach) s.push_back(s[0] + n);
      if (inside > n - reach) s.push_back(s[0] - n);
    }
    return s;
  };
  for (std::size_t i = 0; i < discs.size(); ++i)
    for (const double dx : shifts(discs[i].centre.x(), domain.nx, domain.x))
      for (const double dy : shifts(discs[i].centre.y(), domain.ny, domain.y))
        all.push_back({i, discs[i].centre + Vec2(dx, dy)});
  return all;
}

}  // namespace

double Lubrication::resistance(double gap, double radius) const {
  if (gap >= range) return 0.0;
  const auto zeta = [&](double h) {
    const double ratio = radius / std::max(h, kRoughness * radius);
    return 3.0 * std::numbers::sqrt2 * std::numbers::pi * viscosity * ratio * std::sqrt(ratio);
  };
  return zeta(gap) - zeta(range);
}

double Lubrication::force(double gap, double radius, double approach, double mass) const {
  const double zeta = resistance(gap, radius);
  return zeta * approach / (1.0 + zeta * interval / mass);
}

void Lubrication::add_walls(const Disc& d, double mass, const Domain& domain,
                            DiscLoad& load) const {
  const auto axis = [&](int k, int n, Side side) {
    if (side == Side::Periodic) return;
    load.force[k] += force(d.centre[k] - d.radius, d.radius, -d.velocity[k], mass);
    load.force[k] -= force(n - d.centre[k] - d.radius, d.radius, d.velocity[k], mass);
  };
  axis(0, domain.nx, domain.x);
  axis(1, domain.ny, domain.y);
}

void Lubrication::add(std::span<const Disc> discs, std::span<const double> masses,
                      const Domain& domain, std::span<DiscLoad> loads) const {
  double largest = 0.0;
  for (const Disc& d : discs) largest = std::max(largest, d.hollow ? 0.0 : d.radius);
  const double reach = 2.0 * largest + range;
  std::vector<Image> all = images(discs, domain, reach);
  std::sort(all.begin(), all.end(), [](const Image& a, const Image& b) {
    return std::pair(a.centre.x(), a.disc) < std::pair(b.centre.x(), b.disc);
  });
  for (std::size_t i = 0; i < discs.size(); ++i)
    if (!discs[i].hollow && std::isfinite(masses[i]))
      add_walls(discs[i], masses[i], domain, loads[i]);
  // Every image pair is met once; the force goes to the disc that is at home, so that a pair across
  // a side is not counted for its second image.
  for (std::size_t i = 0; i < all.size(); ++i)
    for (std::size_t j = i + 1; j < all.size() && all[j].centre.x() - all[i].centre.x() < reach;
         ++j) {
      const Disc &a = discs[all[i].disc], &b = discs[all[j].disc];
      if (all[i].disc == all[j].disc || a.hollow || b.hollow) continue;
      const Vec2 apart = all[j].centre - all[i].centre;
      const double distance = apart.norm(), gap = distance - a.radius - b.radius;
      const double inverse = 1.0 / masses[all[i].disc] + 1.0 / masses[all[j].disc];
      if (gap >= range || distance == 0.0 || inverse == 0.0) continue;
      const Vec2 normal = apart / distance;
      const double approach = (a.velocity - b.velocity).dot(normal);
      const double radius = a.radius * b.radius / (a.radius + b.radius);
      const Vec2 push = force(gap, radius, approach, 1.0 / inverse) * normal;
      const auto home = [&](const Image& m) {
        const auto in = [](double v, int n, Side s) {
          return s == Side::Wall || (v >= 0.0 && v < n);
        };
        return in(m.centre.x(), domain.nx, domain.x) && in(m.centre.y(), domain.ny, domain.y);
      };
      if (home(all[i])) loads[all[i].disc].force -= push;
      if (home(all[j])) loads[all[j].disc].force += push;
    }
}

}  // namespace lbm
