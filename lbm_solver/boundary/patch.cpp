// SPDX-License-Identifier: GPL-2.0-or-later
#include "lbm_solver/boundary/patch.h"

#include <cmath>
#include <numbers>

namespace lbm {
namespace {

constexpr double kCourant = 0.57735026918962576;  // c_s: cells that sound crosses in a step

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

double InTime::factor(std::int64_t step) const {
  const double t = static_cast<double>(step), pi = std::numbers::pi;
  const double up = t < ramp_steps ? 0.5 * (1.0 - std::cos(pi * t / ramp_steps)) : 1.0;
  return period_steps > 0.0 ? up * std::cos(2.0 * pi * t / period_steps) : up;
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

Population arriving(Populations& f, const EsotericPull& stream, int q, const Cell3& cell) {
  return stream.arriving(f, q, cell[0], cell[1], cell[2]);
}
CellMoments moments_at(const Populations& f, const EsotericPull& stream, const Cell3& cell) {
  return cell_moments(f, stream, cell[0], cell[1], cell[2]);
}

}  // namespace

void VelocityPatch::apply(Populations& f, const EsotericPull& stream, std::int64_t step) {
  const double factor = in_time_.factor(step);
  for (std::size_t i = 0; i < links_.size(); ++i) {
    const Population population = arriving(f, stream, links_[i].q, links_[i].cell);
    replace(population, population + factor * gain_[i]);
  }
}

DensityPatch::DensityPatch(std::vector<Link> links, SideName side, double drho,
                           const InTime& in_time)
    : Patch(std::move(links)), drho_(drho), in_time_(in_time) {
  inward_[axis_of(side)] = is_high(side) ? -1 : 1;
}

void PressurePatch::apply(Populations& f, const EsotericPull& stream, std::int64_t step) {
  const double target = drho(step);
  const Lattice& l = f.lattice();
  for (const Link& link : links_) {
    const CellMoments in = moments_at(f, stream, inner(link));
    const Vec3 u = in.velocity();
    const double at_cell = (2.0 * target + in.drho) / 3.0;
    const double per_density =
        l.w[link.q] * (1.0 + 3.0 * velocity_of(l, link.q).dot(u) + square_terms(l, link.q, u));
    replace(arriving(f, stream, link.q, link.cell),
            arriving(f, stream, link.q, inner(link)) + (at_cell - in.drho) * per_density);
  }
}

OutflowPatch::OutflowPatch(std::vector<Link> links, SideName side, double drho, double relax)
    : DensityPatch(std::move(links), side, drho, InTime{}),
      relax_(relax),
      memory_(links_.size(), 0.0) {}

void OutflowPatch::apply(Populations& f, const EsotericPull& stream, std::int64_t step) {
  const double target = drho(step);
  for (std::size_t i = 0; i < links_.size(); ++i) {
    const Link& link = links_[i];
    const double inside = arriving(f, stream, link.q, inner(link));
    const double carried = (memory_[i] + kCourant * inside) / (1.0 + kCourant);
    const double excess = target - moments_at(f, stream, inner(link)).drho;
    memory_[i] = carried + relax_ * f.lattice().w[link.q] * excess;
    replace(arriving(f, stream, link.q, link.cell), memory_[i]);
  }
}

void PressureJumpPatch::apply(Populations& f, const EsotericPull& stream, std::int64_t step) {
  const double jump = drho(step);
  const Lattice& l = f.lattice();
  for (const Link& link : links_) {
    const Vec3 u = moments_at(f, stream, inner(link)).velocity();
    const Population population = arriving(f, stream, link.q, link.cell);
    replace(population, population + l.w[link.q] * jump * (1.0 + square_terms(l, link.q, u)));
  }
}

}  // namespace lbm
