// SPDX-License-Identifier: GPL-2.0-or-later
#include "lbm_solver/boundary/patch.h"

#include <algorithm>
#include <cmath>

namespace lbm {
namespace {

constexpr double kCourant = 0.57735026918962576;  // c_s: cells that sound crosses in a step
constexpr double kInflow = 0.02;  // speed from which an outflow that runs backwards is a reservoir

/// The axes along a side.
std::array<int, 2> axes_along(SideName side) {
  const int axis = axis_of(side);
  return {axis == 0 ? 1 : 0, axis == 2 ? 1 : 2};
}

}  // namespace

Opening Opening::whole(const Domain& domain, SideName side) {
  Opening o;
  o.side = side;
  for (int k = 0; k < 2; ++k) {
    const int axis = axes_along(side)[k];
    o.end[k] = domain.cells()[axis];
    o.closed[k] = domain.sides()[axis] == Side::Periodic;
  }
  return o;
}

std::vector<Link> side_links(const Lattice& lattice, const Domain& domain, const Block& cells,
                             const Opening& o) {
  const int axis = axis_of(o.side), inward = is_high(o.side) ? -1 : 1;
  const auto along = axes_along(o.side);
  std::vector<Link> links;
  std::int64_t number = 0;
  Cell3 cell;
  cell[axis] = is_high(o.side) ? domain.cells()[axis] - 1 : 0;
  for (int t = o.begin[1]; t < o.end[1]; ++t)
    for (int s = o.begin[0]; s < o.end[0]; ++s) {
      cell[along[0]] = s;
      cell[along[1]] = t;
      for (int q = 1; q < lattice.Q; ++q) {
        if (lattice.c[q][axis] != inward) continue;
        const std::array<double, 2> at{s + 0.5 - 0.5 * lattice.c[q][along[0]],
                                       t + 0.5 - 0.5 * lattice.c[q][along[1]]};
        const auto inside = [&](int k) {
          return o.closed[k] || (at[k] > o.begin[k] && at[k] < o.end[k]);
        };
        if (!inside(0) || !inside(1)) continue;
        if (cells.holds(cell))
          links.push_back(
              {{cell[0] - cells.begin[0], cell[1] - cells.begin[1], cell[2] - cells.begin[2]},
               q,
               at,
               number});
        ++number;
      }
    }
  return links;
}

namespace {

/// Where a place lies in a rising list: the line below, and the part of the way to the next.
struct Between {
  std::size_t below = 0;
  double part = 0.0;
};
Between between(const std::vector<double>& places, double at) {
  const auto above = std::ranges::upper_bound(places, at);
  if (above == places.begin()) return {};
  const auto below = static_cast<std::size_t>(above - places.begin()) - 1;
  if (above == places.end()) return {below, 0.0};
  return {below, (at - places[below]) / (*above - places[below])};
}

}  // namespace

double SideProfile::factor(const std::array<double, 2>& at) const {
  const Between s = between(places[0], at[0]), t = between(places[1], at[1]);
  const std::size_t row = std::max<std::size_t>(1, places[0].size());
  const auto along = [&](std::size_t line) {
    const double* first = &factors[line * row + s.below];
    return s.part > 0.0 ? std::lerp(first[0], first[1], s.part) : first[0];
  };
  const double here = along(t.below);
  return t.part > 0.0 ? std::lerp(here, along(t.below + 1), t.part) : here;
}

VelocityPatch::VelocityPatch(const Lattice& lattice, std::vector<Link> links, const Vec3& velocity,
                             const SideProfile& profile, const InTime& in_time)
    : Patch(std::move(links)), in_time_(in_time) {
  for (const Link& link : links_)
    gain_.push_back(6.0 * lattice.w[link.q] * profile.factor(link.at) *
                    velocity_of(lattice, link.q).dot(velocity));
}

VelocityPatch::VelocityPatch(const Lattice& lattice, std::vector<Link> links, const Vec3& velocity,
                             bool parabolic, const Opening& o, const InTime& in_time)
    : Patch(std::move(links)), in_time_(in_time) {
  for (const Link& link : links_) {
    double shape = 1.0;
    for (int k = 0; k < 2; ++k) {
      const double s = link.at[k] - o.begin[k], length = o.end[k] - o.begin[k];
      if (parabolic && !o.closed[k]) shape *= 4.0 * s * (length - s) / (length * length);
    }
    gain_.push_back(6.0 * lattice.w[link.q] * shape * velocity_of(lattice, link.q).dot(velocity));
  }
}

namespace {

Population arriving(const Patch::Sweep& s, int q, const Cell3& cell) {
  return s.stream.arriving(s.f, q, cell[0], cell[1], cell[2]);
}
CellMoments moments_at(const Patch::Sweep& s, const Cell3& cell) {
  return cell_moments(s.f, s.stream, cell[0], cell[1], cell[2]);
}

}  // namespace

void VelocityPatch::apply(const Sweep& sweep) {
  const double factor = in_time_.factor(sweep.step);
  for (std::size_t i = 0; i < links_.size(); ++i) {
    const Population population = arriving(sweep, links_[i].q, links_[i].cell);
    replace(population, population + factor * gain_[i]);
  }
}

DensityPatch::DensityPatch(std::vector<Link> links, SideName side, double drho,
                           const InTime& in_time)
    : Patch(std::move(links)), drho_(drho), in_time_(in_time) {
  inward_[axis_of(side)] = is_high(side) ? -1 : 1;
}

double DensityPatch::at_density(const Sweep& sweep, const Link& link, double drho) const {
  const Lattice& l = sweep.f.lattice();
  const CellMoments in = moments_at(sweep, inner(link));
  const Vec3 u = in.velocity();
  const double at_cell = (2.0 * drho + in.drho) / 3.0;
  const double per_density =
      l.w[link.q] * (1.0 + 3.0 * velocity_of(l, link.q).dot(u) + square_terms(l, link.q, u));
  return arriving(sweep, link.q, inner(link)) + (at_cell - in.drho) * per_density;
}

void PressurePatch::apply(const Sweep& sweep) {
  const double target = drho(sweep.step);
  for (const Link& link : links_)
    replace(arriving(sweep, link.q, link.cell), at_density(sweep, link, target));
}

OutflowPatch::OutflowPatch(std::vector<Link> links, SideName side, double drho, double relax)
    : DensityPatch(std::move(links), side, drho, InTime{}),
      relax_(relax),
      memory_(links_.size(), 0.0) {}

double OutflowPatch::held_part(const Sweep& sweep, const Link& link, double inflow) const {
  double held = std::min(1.0, inflow / kInflow);
  if (!sweep.solid_fraction) return held;
  for (const Cell3& cell : {link.cell, inner(link)})
    held = std::max(held, sweep.solid_fraction(cell));
  return held;
}

void OutflowPatch::apply(const Sweep& sweep) {
  const double target = drho(sweep.step);
  for (std::size_t i = 0; i < links_.size(); ++i) {
    const Link& link = links_[i];
    const double inside = arriving(sweep, link.q, inner(link));
    const double carried = (memory_[i] + kCourant * inside) / (1.0 + kCourant);
    const CellMoments in = moments_at(sweep, inner(link));
    memory_[i] = carried + relax_ * sweep.f.lattice().w[link.q] * (target - in.drho);
    const double inflow = std::max(0.0, in.velocity().dot(inward()));
    const double held = held_part(sweep, link, inflow);
    if (held > 0.0) {
      const double from_rest = target - 1.5 * inflow * inflow;
      memory_[i] += held * (at_density(sweep, link, from_rest) - memory_[i]);
    }
    replace(arriving(sweep, link.q, link.cell), memory_[i]);
  }
}

void PressureJumpPatch::apply(const Sweep& sweep) {
  const double jump = drho(sweep.step);
  const Lattice& l = sweep.f.lattice();
  for (const Link& link : links_) {
    const Vec3 u = moments_at(sweep, inner(link)).velocity();
    const Population population = arriving(sweep, link.q, link.cell);
    replace(population, population + l.w[link.q] * jump * (1.0 + square_terms(l, link.q, u)));
  }
}

}  // namespace lbm
