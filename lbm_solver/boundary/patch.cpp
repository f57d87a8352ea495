// SPDX-License-Identifier: GPL-2.0-or-later
#include "lbm_solver/boundary/patch.h"

#include <cmath>
#include <numbers>

#include "lbm_solver/collision/equilibrium.h"

namespace lbm {
namespace {

/// Unit step from a side into the box.
struct Inward {
  int x, y;
};
Inward inward(SideName side) {
  switch (side) {
    case SideName::Left:
      return {1, 0};
    case SideName::Right:
      return {-1, 0};
    case SideName::Bottom:
      return {0, 1};
    case SideName::Top:
      return {0, -1};
  }
  return {0, 0};
}

constexpr double kCourant = 0.57735026918962576;  // c_s: cells that sound crosses in a step

/// 9/2 (c·u)² - 3/2 u²
double square_terms(int q, double ux, double uy) {
  const double cu = D2Q9::c[q][0] * ux + D2Q9::c[q][1] * uy;
  return 4.5 * cu * cu - 1.5 * (ux * ux + uy * uy);
}

}  // namespace

std::vector<Link> side_links(int nx, int ny, SideName side, int begin, int end, bool closed) {
  const Inward in = inward(side);
  const bool vertical = in.x != 0;  // the side runs along y
  std::vector<Link> links;
  for (int s = begin; s < end; ++s) {
    const int x = vertical ? (side == SideName::Left ? 0 : nx - 1) : s;
    const int y = vertical ? s : (side == SideName::Bottom ? 0 : ny - 1);
    for (int q = 1; q < D2Q9::Q; ++q) {
      if (D2Q9::c[q][0] * in.x + D2Q9::c[q][1] * in.y != 1) continue;
      const int sideways = vertical ? D2Q9::c[q][1] : D2Q9::c[q][0];
      const double at = s + 0.5 - 0.5 * sideways;
      if (closed || (at > begin && at < end)) links.push_back({x, y, q, at});
    }
  }
  return links;
}

double InTime::factor(std::int64_t step) const {
  const double t = static_cast<double>(step), pi = std::numbers::pi;
  const double up = t < ramp_steps ? 0.5 * (1.0 - std::cos(pi * t / ramp_steps)) : 1.0;
  return period_steps > 0.0 ? up * std::cos(2.0 * pi * t / period_steps) : up;
}

Patch::Inner Patch::inner(const Populations& f, const EsotericPull& stream, int x, int y) {
  double cell[D2Q9::Q];
  for (int q = 0; q < D2Q9::Q; ++q) cell[q] = stream.arriving(f, q, x, y);
  const Moments<double> m = moments(cell);
  return {m.drho, m.jx / (m.drho + 1.0), m.jy / (m.drho + 1.0)};
}

VelocityPatch::VelocityPatch(std::vector<Link> links, const Vec2& velocity, bool parabolic,
                             int begin, int end, const InTime& in_time)
    : Patch(std::move(links)), in_time_(in_time) {
  const double length = end - begin;
  for (const Link& link : links_) {
    const double s = link.at - begin;
    const double shape = parabolic ? 4.0 * s * (length - s) / (length * length) : 1.0;
    const double cu = D2Q9::c[link.q][0] * velocity.x() + D2Q9::c[link.q][1] * velocity.y();
    gain_.push_back(6.0 * D2Q9::w[link.q] * shape * cu);
  }
}

void VelocityPatch::apply(Populations& f, const EsotericPull& stream, std::int64_t step) {
  const double factor = in_time_.factor(step);
  for (std::size_t i = 0; i < links_.size(); ++i) {
    double& population = stream.arriving(f, links_[i].q, links_[i].x, links_[i].y);
    replace(population, population + factor * gain_[i]);
  }
}

DensityPatch::DensityPatch(std::vector<Link> links, SideName side, double drho,
                           const InTime& in_time)
    : Patch(std::move(links)),
      inward_x_(inward(side).x),
      inward_y_(inward(side).y),
      drho_(drho),
      in_time_(in_time) {}

void PressurePatch::apply(Populations& f, const EsotericPull& stream, std::int64_t step) {
  const double target = drho(step);
  for (const Link& link : links_) {
    const int x = link.x + inward_x_, y = link.y + inward_y_;
    const Inner in = inner(f, stream, x, y);
    const double at_cell = (2.0 * target + in.drho) / 3.0;
    const double cu = D2Q9::c[link.q][0] * in.ux + D2Q9::c[link.q][1] * in.uy;
    const double per_density =
        D2Q9::w[link.q] * (1.0 + 3.0 * cu + square_terms(link.q, in.ux, in.uy));
    replace(stream.arriving(f, link.q, link.x, link.y),
            stream.arriving(f, link.q, x, y) + (at_cell - in.drho) * per_density);
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
    const int x = link.x + inward_x_, y = link.y + inward_y_;
    const double carried =
        (memory_[i] + kCourant * stream.arriving(f, link.q, x, y)) / (1.0 + kCourant);
    const double pull = relax_ * D2Q9::w[link.q] * (target - inner(f, stream, x, y).drho);
    memory_[i] = carried + pull;
    replace(stream.arriving(f, link.q, link.x, link.y), memory_[i]);
  }
}

void PressureJumpPatch::apply(Populations& f, const EsotericPull& stream, std::int64_t step) {
  const double jump = drho(step);
  for (const Link& link : links_) {
    const Inner in = inner(f, stream, link.x + inward_x_, link.y + inward_y_);
    double& population = stream.arriving(f, link.q, link.x, link.y);
    replace(population,
            population + D2Q9::w[link.q] * jump * (1.0 + square_terms(link.q, in.ux, in.uy)));
  }
}

}  // namespace lbm
