// SPDX-License-Identifier: GPL-2.0-or-later
#include "lbm_solver/immersed/linked_bodies.h"

#include <algorithm>
#include <cmath>

#include "lbm_solver/field/cell_pass.h"

namespace lbm {
namespace {

/// Depth of a place below the surface of a body; negative outside it.
double depth(const Body& body, const Vec3& arm) {
  const double below = body.radius - arm.norm();
  return body.hollow ? -below : below;
}

/// Part δ of a link from arm (in the fluid) along step (into the solid) at which it meets the
/// circle or sphere of radius r: |arm + δ step| = r.
double cut(const Vec3& arm, const Vec3& step, double r) {
  const double a = step.squaredNorm(), b = arm.dot(step), c = arm.squaredNorm() - r * r;
  const double root = std::sqrt(std::max(0.0, b * b - a * c));
  const double delta = c > 0.0 ? (-b - root) / a : (-b + root) / a;  // from outside, from inside
  return std::clamp(delta, 1e-6, 1.0);
}

CellMoments moments_of(const Populations& f, const EsotericPull& stream, const Cell3& c) {
  return cell_moments(f, stream, c[0], c[1], c[2]);
}

}  // namespace

LinkedBodies::LinkedBodies(const Domain& domain, const Lattice& lattice, WallPlace place)
    : domain_(domain),
      lattice_(lattice),
      place_(place),
      owners_(static_cast<std::size_t>(domain.nx) * domain.ny * domain.nz, -1) {}

bool LinkedBodies::inside(Cell3& cell) const {
  for (int a = 0; a < 3; ++a) {
    const int n = domain_.cells()[a];
    if (cell[a] >= 0 && cell[a] < n) continue;
    if (domain_.sides()[a] == Side::Wall) return false;
    cell[a] = (cell[a] + n) % n;
  }
  return true;
}

Cell3 LinkedBodies::beside(const Cell3& cell, int q) const {
  const int* c = lattice_.c[q];
  return {cell[0] + c[0], cell[1] + c[1], cell[2] + c[2]};
}

template <class F>
void LinkedBodies::each_cell(F&& f) const {
  for (int z = 0; z < domain_.nz; ++z)
    for (int y = 0; y < domain_.ny; ++y)
      for (int x = 0; x < domain_.nx; ++x) f(Cell3{x, y, z});
}

Vec3 LinkedBodies::arm(const Body& body, const Cell3& c) const {
  const Vec3 centre(c[0] + 0.5, c[1] + 0.5, domain_.dimension() == 3 ? c[2] + 0.5 : 0.0);
  return domain_.nearest_image(centre - body.centre);
}

/// The body in which a cell's centre lies deepest; the order of the bodies plays no part.
LinkedBodies::Owners LinkedBodies::find_owners() const {
  Owners owners(owners_.size(), -1);
  for (std::size_t d = 0; d < bodies_.size(); ++d) {
    const Body& body = bodies_[d];
    Footprint footprint;
    footprint.update(body, domain_);
    for (const auto& span : footprint.spans())
      for (int x = span.x(); x < std::min(span.x() + span.count(), domain_.nx); ++x) {
        const Cell3 cell{x, span.y, span.z};
        const double here = depth(body, arm(body, cell));
        if (here <= 0.0) continue;
        std::int32_t& owner = owners[index(cell)];
        const double other = owner < 0 ? 0.0 : depth(bodies_[owner], arm(bodies_[owner], cell));
        if (owner < 0 || here > other || (here == other && body.id < bodies_[owner].id))
          owner = static_cast<std::int32_t>(d);
      }
  }
  return owners;
}

void LinkedBodies::find_links() {
  links_.clear();
  each_cell([&](const Cell3& cell) {
    if (owners_[index(cell)] >= 0) return;
    for (int q = 1; q < lattice_.Q; ++q) {
      Cell3 solid = beside(cell, opposite(q));
      if (!inside(solid)) continue;
      const std::int32_t owner = owners_[index(solid)];
      if (owner < 0) continue;
      const Body& body = bodies_[owner];
      const Vec3 from = arm(body, cell), step = -velocity_of(lattice_, q);
      const double delta = place_ == WallPlace::HalfWay ? 0.5 : cut(from, step, body.radius);
      links_.push_back({cell, q, solid, owner, delta, from + delta * step});
    }
  });
}

/// Cells that became solid or fluid since the step before, and the fluid inside the solids, which
/// is held at rest in their frame: they take the body force of the cells that they hold.
void LinkedBodies::change_cells(const Owners& before, Populations& f, const EsotericPull& stream) {
  each_cell([&](const Cell3& cell) {
    const std::int32_t was = before[index(cell)], is = owners_[index(cell)];
    if (was < 0 && is < 0) return;
    if (is >= 0) {
      const Vec3 a = arm(bodies_[is], cell);
      loads_[is].add(body_force_, a);
      if (was < 0) loads_[is].add(moments_of(f, stream, cell).j, a);
      set_equilibrium(f, stream, cell, 0.0, bodies_[is].velocity_at(a));
      return;
    }
    double density = 0.0;
    int neighbours = 0;
    for (int q = 1; q < lattice_.Q; ++q) {
      Cell3 next = beside(cell, q);
      if (!inside(next) || owners_[index(next)] >= 0 || before[index(next)] >= 0) continue;
      density += moments_of(f, stream, next).drho;
      ++neighbours;
    }
    const double drho = neighbours > 0 ? density / neighbours : 0.0;
    if (was >= static_cast<std::int32_t>(bodies_.size()) || bodies_[was].id != ids_before_[was]) {
      set_equilibrium(f, stream, cell, drho, {0.0, 0.0});  // its body has left the scene
      return;
    }
    const Vec3 a = arm(bodies_[was], cell), u = bodies_[was].velocity_at(a);
    set_equilibrium(f, stream, cell, drho, u);
    loads_[was].add(-(1.0 + drho) * u, a);
  });
}

void LinkedBodies::before_sweep(std::span<const Body> bodies, Populations& f,
                                const EsotericPull& stream) {
  const bool same_place =
      std::equal(bodies.begin(), bodies.end(), bodies_.begin(), bodies_.end(),
                 [](const Body& a, const Body& b) {
                   return a.centre == b.centre && a.radius == b.radius && a.hollow == b.hollow;
                 });
  ids_before_.clear();
  for (const Body& b : bodies_) ids_before_.push_back(b.id);
  bodies_.assign(bodies.begin(), bodies.end());
  loads_.assign(bodies.size(), BodyLoad{});
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
  const auto at = [&](int q, const Cell3& c) { return stream.arriving(f, q, c[0], c[1], c[2]); };
  const int back = opposite(l.q);
  const double out = at(back, l.solid);  // f_-q* of the fluid cell
  const Vec3 u = bodies_[l.body].velocity_at(l.arm);
  const double wall = 6.0 * lattice_.w[l.q] * velocity_of(lattice_, l.q).dot(u);
  if (l.delta == 0.5) return out + wall;
  Cell3 next = beside(l.cell, l.q);
  const bool exists = inside(next);
  if (l.delta < 0.5) {
    if (!exists || owners_[index(next)] >= 0) return out + wall;  // no second fluid cell
    return 2.0 * l.delta * out + (1.0 - 2.0 * l.delta) * at(back, l.cell) + wall;
  }
  const double part = 0.5 / l.delta;
  const double forward = exists ? at(l.q, next) : at(back, l.cell);
  return part * (out + wall) + (1.0 - part) * forward;
}

void LinkedBodies::after_sweep(Populations& f, const EsotericPull& stream) {
  arriving_.resize(links_.size());
  for (std::size_t i = 0; i < links_.size(); ++i) arriving_[i] = incoming(links_[i], f, stream);
  for (std::size_t i = 0; i < links_.size(); ++i) {
    const Link& l = links_[i];
    const double out = stream.arriving(f, opposite(l.q), l.solid[0], l.solid[1], l.solid[2]);
    stream.arriving(f, l.q, l.cell[0], l.cell[1], l.cell[2]) = arriving_[i];
    loads_[l.body].add(-(out + arriving_[i]) * velocity_of(lattice_, l.q), l.arm);
  }
}

}  // namespace lbm
