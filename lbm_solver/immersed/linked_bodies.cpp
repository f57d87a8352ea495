// SPDX-License-Identifier: GPL-2.0-or-later
#include "lbm_solver/immersed/linked_bodies.h"

#include <algorithm>
#include <cmath>

#include "lbm_solver/collision/equilibrium.h"

namespace lbm {
namespace {

Vec2 direction(int q) {
  return {D2Q9::c[q][0], D2Q9::c[q][1]};
}

/// Depth of a place below the surface of a disc; negative outside it.
double depth(const Disc& disc, const Vec2& arm) {
  const double below = disc.radius - arm.norm();
  return disc.hollow ? -below : below;
}

Moments<double> moments_of(const Populations& f, const EsotericPull& stream, int x, int y) {
  double cell[D2Q9::Q];
  for (int q = 0; q < D2Q9::Q; ++q) cell[q] = stream.arriving(f, q, x, y);
  return moments(cell);
}

void set_equilibrium(Populations& f, const EsotericPull& stream, int x, int y, double drho,
                     const Vec2& u) {
  const Equilibrium<double> eq(drho, u.x(), u.y());
  stream.arriving(f, 0, x, y) = eq.rest();
  unroll<D2Q9::pairs>([&](auto p) {
    constexpr int i = 2 * p + 1;
    const auto halves = eq.pair<i>();
    stream.arriving(f, i, x, y) = halves.even + halves.odd;
    stream.arriving(f, i + 1, x, y) = halves.even - halves.odd;
  });
}

/// Part δ of a link from arm (in the fluid) along step (into the solid) at which it meets the
/// circle of radius r: |arm + δ step| = r.
double cut(const Vec2& arm, const Vec2& step, double r) {
  const double a = step.squaredNorm(), b = arm.dot(step), c = arm.squaredNorm() - r * r;
  const double root = std::sqrt(std::max(0.0, b * b - a * c));
  const double delta = c > 0.0 ? (-b - root) / a : (-b + root) / a;  // from outside, from inside
  return std::clamp(delta, 1e-6, 1.0);
}

}  // namespace

LinkedBodies::LinkedBodies(const Domain& domain, WallPlace place, const Vec2& body_force)
    : domain_(domain),
      place_(place),
      body_force_(body_force),
      owners_(static_cast<std::size_t>(domain.nx) * domain.ny, -1) {}

bool LinkedBodies::inside(int& x, int& y) const {
  const auto bring = [](int& v, int n, Side side) {
    if (v >= 0 && v < n) return true;
    v = (v + n) % n;
    return side == Side::Periodic;
  };
  return bring(x, domain_.nx, domain_.x) && bring(y, domain_.ny, domain_.y);
}

Vec2 LinkedBodies::arm(const Disc& disc, int x, int y) const {
  Vec2 a = Vec2(x + 0.5, y + 0.5) - disc.centre;
  if (domain_.x == Side::Periodic) a.x() -= domain_.nx * std::round(a.x() / domain_.nx);
  if (domain_.y == Side::Periodic) a.y() -= domain_.ny * std::round(a.y() / domain_.ny);
  return a;
}

Vec2 LinkedBodies::velocity(const Disc& disc, const Vec2& a) const {
  return disc.velocity + disc.spin * Vec2(-a.y(), a.x());
}

/// The disc in which a cell's centre lies deepest; the order of the discs plays no part.
LinkedBodies::Owners LinkedBodies::find_owners() const {
  Owners owners(owners_.size(), -1);
  for (std::size_t d = 0; d < discs_.size(); ++d) {
    Footprint footprint;
    footprint.update(discs_[d], domain_);
    for (const auto& span : footprint.spans())
      for (int x = span.x(); x < std::min(span.x() + span.count(), domain_.nx); ++x) {
        const double here = depth(discs_[d], arm(discs_[d], x, span.y));
        if (here <= 0.0) continue;
        std::int32_t& owner = owners[index(x, span.y)];
        const double other = owner < 0 ? 0.0 : depth(discs_[owner], arm(discs_[owner], x, span.y));
        if (owner < 0 || here > other || (here == other && discs_[d].id < discs_[owner].id))
          owner = static_cast<std::int32_t>(d);
      }
  }
  return owners;
}

void LinkedBodies::find_links() {
  links_.clear();
  for (int y = 0; y < domain_.ny; ++y)
    for (int x = 0; x < domain_.nx; ++x) {
      if (owners_[index(x, y)] >= 0) continue;
      for (int q = 1; q < D2Q9::Q; ++q) {
        int sx = x - D2Q9::c[q][0], sy = y - D2Q9::c[q][1];
        if (!inside(sx, sy)) continue;
        const std::int32_t owner = owners_[index(sx, sy)];
        if (owner < 0) continue;
        const Disc& disc = discs_[owner];
        const Vec2 from = arm(disc, x, y), step = -direction(q);
        const double delta = place_ == WallPlace::HalfWay ? 0.5 : cut(from, step, disc.radius);
        links_.push_back({x, y, q, sx, sy, owner, delta, from + delta * step});
      }
    }
}

/// Cells that became solid or fluid since the step before, and the fluid inside the solids, which
/// is held at rest in their frame.
void LinkedBodies::change_cells(const Owners& before, Populations& f, const EsotericPull& stream) {
  for (int y = 0; y < domain_.ny; ++y)
    for (int x = 0; x < domain_.nx; ++x) {
      const std::int32_t was = before[index(x, y)], is = owners_[index(x, y)];
      if (was < 0 && is < 0) continue;
      if (is >= 0) {
        const Vec2 a = arm(discs_[is], x, y);
        loads_[is].force += body_force_;
        loads_[is].torque += a.x() * body_force_.y() - a.y() * body_force_.x();
        if (was < 0) {
          const Moments<double> m = moments_of(f, stream, x, y);
          loads_[is].force += Vec2(m.jx, m.jy);
          loads_[is].torque += a.x() * m.jy - a.y() * m.jx;
        }
        set_equilibrium(f, stream, x, y, 0.0, velocity(discs_[is], a));
        continue;
      }
      double density = 0.0;
      int neighbours = 0;
      for (int q = 1; q < D2Q9::Q; ++q) {
        int nx = x + D2Q9::c[q][0], ny = y + D2Q9::c[q][1];
        if (!inside(nx, ny) || owners_[index(nx, ny)] >= 0 || before[index(nx, ny)] >= 0) continue;
        density += moments_of(f, stream, nx, ny).drho;
        ++neighbours;
      }
      const double drho = neighbours > 0 ? density / neighbours : 0.0;
      if (was >= static_cast<std::int32_t>(discs_.size()) || discs_[was].id != ids_before_[was]) {
        set_equilibrium(f, stream, x, y, drho, {0.0, 0.0});  // its disc has left the scene
        continue;
      }
      const Vec2 a = arm(discs_[was], x, y), u = velocity(discs_[was], a), j = (1.0 + drho) * u;
      set_equilibrium(f, stream, x, y, drho, u);
      loads_[was].force -= j;
      loads_[was].torque -= a.x() * j.y() - a.y() * j.x();
    }
}

void LinkedBodies::before_sweep(std::span<const Disc> discs, Populations& f,
                                const EsotericPull& stream) {
  const bool same_place = std::equal(
      discs.begin(), discs.end(), discs_.begin(), discs_.end(), [](const Disc& a, const Disc& b) {
        return a.centre == b.centre && a.radius == b.radius && a.hollow == b.hollow;
      });
  ids_before_.clear();
  for (const Disc& d : discs_) ids_before_.push_back(d.id);
  discs_.assign(discs.begin(), discs.end());
  loads_.assign(discs.size(), DiscLoad{});
  if (same_place) {
    change_cells(owners_, f, stream);
    return;
  }
  Owners before = find_owners();
  before.swap(owners_);
  find_links();
  change_cells(before, f, stream);
}

double LinkedBodies::incoming(const Link& l, const Populations& f,
                              const EsotericPull& stream) const {
  const int back = D2Q9::opposite(l.q);
  const Disc& disc = discs_[l.disc];
  const double out = stream.arriving(f, back, l.solid_x, l.solid_y);  // f_-q* of the fluid cell
  const double wall = 6.0 * D2Q9::w[l.q] * direction(l.q).dot(velocity(disc, l.arm));
  int x = l.x + D2Q9::c[l.q][0], y = l.y + D2Q9::c[l.q][1];
  if (l.delta == 0.5) return out + wall;
  const bool exists = inside(x, y);
  if (l.delta < 0.5) {
    if (!exists || owners_[index(x, y)] >= 0) return out + wall;  // no second fluid cell
    return 2.0 * l.delta * out + (1.0 - 2.0 * l.delta) * stream.arriving(f, back, l.x, l.y) + wall;
  }
  const double part = 0.5 / l.delta;
  const double forward =
      exists ? stream.arriving(f, l.q, x, y) : stream.arriving(f, back, l.x, l.y);
  return part * (out + wall) + (1.0 - part) * forward;
}

void LinkedBodies::after_sweep(Populations& f, const EsotericPull& stream) {
  arriving_.resize(links_.size());
  for (std::size_t i = 0; i < links_.size(); ++i) arriving_[i] = incoming(links_[i], f, stream);
  for (std::size_t i = 0; i < links_.size(); ++i) {
    const Link& l = links_[i];
    const double out = stream.arriving(f, D2Q9::opposite(l.q), l.solid_x, l.solid_y);
    stream.arriving(f, l.q, l.x, l.y) = arriving_[i];
    const Vec2 force = -(out + arriving_[i]) * direction(l.q);
    loads_[l.disc].force += force;
    loads_[l.disc].torque += l.arm.x() * force.y() - l.arm.y() * force.x();
  }
}

}  // namespace lbm
