// SPDX-License-Identifier: GPL-2.0-or-later
#include "lbm_solver/coupling/lubrication.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "lbm_solver/field/decomposition.h"

namespace lbm {
namespace {

constexpr double kRoughness =
    1e-3;  // smallest gap over R*: the force of a true contact is the solid's

/// An image of a body, so that neighbours across periodic sides are found by position alone.
struct Image {
  std::size_t body;
  Vec3 centre;
};

std::vector<Image> images(std::span<const Body> bodies, const Domain& domain, double reach) {
  std::vector<Image> all;
  const auto shifts = [&](double at, int axis) {
    std::vector<double> s{0.0};
    const int n = domain.cells()[axis];
    if (axis < domain.dimension() && domain.sides()[axis] == Side::Periodic) {
      const double inside = at - std::floor(at / n) * n;
      s[0] = inside - at;
      if (inside < reach) s.push_back(s[0] + n);
      if (inside > n - reach) s.push_back(s[0] - n);
    }
    return s;
  };
  for (std::size_t i = 0; i < bodies.size(); ++i)
    for (const double dx : shifts(bodies[i].centre.x(), 0))
      for (const double dy : shifts(bodies[i].centre.y(), 1))
        for (const double dz : shifts(bodies[i].centre.z(), 2))
          all.push_back({i, bodies[i].centre + Vec3(dx, dy, dz)});
  return all;
}

}  // namespace

double Lubrication::resistance(double gap, double radius, bool spheres) const {
  if (gap >= range) return 0.0;
  const auto zeta = [&](double h) {
    const double ratio = radius / std::max(h, kRoughness * radius);
    return spheres ? 6.0 * std::numbers::pi * viscosity * radius * ratio
                   : 3.0 * std::numbers::sqrt2 * std::numbers::pi * viscosity * ratio *
                         std::sqrt(ratio);
  };
  return zeta(gap) - zeta(range);
}

double Lubrication::force(double gap, double radius, double approach, double mass,
                          bool spheres) const {
  const double zeta = resistance(gap, radius, spheres);
  return zeta * approach / (1.0 + zeta * interval / mass);
}

void Lubrication::add_walls(const Body& b, double mass, const Domain& domain, const Block& cells,
                            BodyLoad& load) const {
  const bool spheres = domain.dimension() == 3;
  for (int k = 0; k < domain.dimension(); ++k) {
    if (domain.sides()[k] == Side::Periodic) continue;
    for (const double sign : {1.0, -1.0}) {  // low wall, high wall
      const double wall = sign > 0.0 ? 0.0 : domain.cells()[k];
      const double gap = sign * (b.centre[k] - wall) - b.radius;
      Vec3 middle = b.centre;
      middle[k] = wall + 0.5 * sign * gap;
      if (gap < range && holds(domain, cells, middle))
        load.force[k] += sign * force(gap, b.radius, -sign * b.velocity[k], mass, spheres);
    }
  }
}

void Lubrication::add(std::span<const Body> bodies, std::span<const double> masses,
                      const Domain& domain, const Block& cells, std::span<BodyLoad> loads) const {
  double largest = 0.0;
  for (const Body& b : bodies) largest = std::max(largest, b.hollow ? 0.0 : b.radius);
  const double reach = 2.0 * largest + range;
  const bool spheres = domain.dimension() == 3;
  std::vector<Image> all = images(bodies, domain, reach);
  std::sort(all.begin(), all.end(), [](const Image& a, const Image& b) {
    return std::pair(a.centre.x(), a.body) < std::pair(b.centre.x(), b.body);
  });
  for (std::size_t i = 0; i < bodies.size(); ++i)
    if (!bodies[i].hollow && std::isfinite(masses[i]))
      add_walls(bodies[i], masses[i], domain, cells, loads[i]);
  // Every image pair is met once; the force goes to the body that is at home, so that a pair across
  // a side is not counted for its second image.
  for (std::size_t i = 0; i < all.size(); ++i)
    for (std::size_t j = i + 1; j < all.size() && all[j].centre.x() - all[i].centre.x() < reach;
         ++j) {
      const Body &a = bodies[all[i].body], &b = bodies[all[j].body];
      if (all[i].body == all[j].body || a.hollow || b.hollow) continue;
      if (a.carrier != 0 && a.carrier == b.carrier) continue;  // of one clump
      const Vec3 apart = all[j].centre - all[i].centre;
      const double distance = apart.norm(), gap = distance - a.radius - b.radius;
      const double inverse = 1.0 / masses[all[i].body] + 1.0 / masses[all[j].body];
      if (gap >= range || distance == 0.0 || inverse == 0.0) continue;
      const Vec3 normal = apart / distance;
      if (!holds(domain, cells, all[i].centre + (a.radius + 0.5 * gap) * normal)) continue;
      const double approach = (a.velocity - b.velocity).dot(normal);
      const double radius = a.radius * b.radius / (a.radius + b.radius);
      const Vec3 push = force(gap, radius, approach, 1.0 / inverse, spheres) * normal;
      const auto home = [&](const Image& m) {
        for (int k = 0; k < domain.dimension(); ++k)
          if (domain.sides()[k] == Side::Periodic &&
              (m.centre[k] < 0.0 || m.centre[k] >= domain.cells()[k]))
            return false;
        return true;
      };
      if (home(all[i])) loads[all[i].body].force -= push;
      if (home(all[j])) loads[all[j].body].force += push;
    }
}

}  // namespace lbm
