// SPDX-License-Identifier: GPL-2.0-or-later
#include "lbm_solver/immersed/marked_bodies.h"

#include <cmath>
#include <numbers>
#include <unordered_map>

#include "lbm_solver/collision/equilibrium.h"

namespace lbm {
namespace {

/// Spacing of markers in cells. Closer than about one cell, the columns of A grow alike and the
/// system ill-conditioned.
constexpr double kSpacing = 1.25;
constexpr int kReach = 2;  // of D, cells to either side

/// Peskin's smooth kernel of one axis, support |r| < 2.
double kernel(double r) {
  const double a = std::abs(r);
  if (a >= 2.0) return 0.0;
  if (a >= 1.0) return 0.125 * (5.0 - 2.0 * a - std::sqrt(-7.0 + 12.0 * a - 4.0 * a * a));
  return 0.125 * (3.0 - 2.0 * a + std::sqrt(1.0 + 4.0 * a - 4.0 * a * a));
}

}  // namespace

void MarkedBodies::add_reach(Marker& marker, const Vec2& place) const {
  const int x0 = static_cast<int>(std::floor(place.x() - 0.5)) - kReach + 1;
  const int y0 = static_cast<int>(std::floor(place.y() - 0.5)) - kReach + 1;
  const auto bring = [](int v, int n, Side side) {
    return v >= 0 && v < n ? v : side == Side::Periodic ? ((v % n) + n) % n : -1;
  };
  for (int y = y0; y < y0 + 2 * kReach; ++y)
    for (int x = x0; x < x0 + 2 * kReach; ++x) {
      const int cx = bring(x, domain_.nx, domain_.x), cy = bring(y, domain_.ny, domain_.y);
      const double weight = kernel(x + 0.5 - place.x()) * kernel(y + 0.5 - place.y());
      if (cx >= 0 && cy >= 0 && weight > 0.0)
        marker.reach.push_back({cy * domain_.nx + cx, weight});
    }
}

void MarkedBodies::mark(Body& body) const {
  const double length = 2.0 * std::numbers::pi * body.disc.radius;
  const int count = std::max(4, static_cast<int>(length / kSpacing));
  body.element = length / count;
  body.markers.assign(count, {});
  for (int k = 0; k < count; ++k) {
    const double angle = 2.0 * std::numbers::pi * k / count;
    Marker& m = body.markers[k];
    m.arm = body.disc.radius * Vec2(std::cos(angle), std::sin(angle));
    add_reach(m, body.disc.centre + m.arm);
  }
}

Vec2 MarkedBodies::velocity(std::int32_t cell, const Populations& f,
                            const EsotericPull& stream) const {
  double here[D2Q9::Q];
  for (int q = 0; q < D2Q9::Q; ++q)
    here[q] = stream.arriving(f, q, cell % domain_.nx, cell / domain_.nx);
  const Moments<double> m = moments(here);
  return (Vec2(m.jx, m.jy) + parameters_.half_force) / (1.0 + m.drho);
}

void MarkedBodies::shift(std::int32_t cell, const Vec2& change, Populations& f,
                         const EsotericPull& stream) const {
  const int x = cell % domain_.nx, y = cell / domain_.nx;
  double here[D2Q9::Q];
  for (int q = 0; q < D2Q9::Q; ++q) here[q] = stream.arriving(f, q, x, y);
  const Moments<double> m = moments(here);
  const Vec2 u = Vec2(m.jx, m.jy) / (1.0 + m.drho), to = u + change;
  const Equilibrium<double> before(m.drho, u.x(), u.y()), after(m.drho, to.x(), to.y());
  stream.arriving(f, 0, x, y) += after.rest() - before.rest();
  unroll<D2Q9::pairs>([&](auto p) {
    constexpr int i = 2 * p + 1;
    const auto a = after.pair<i>(), b = before.pair<i>();
    stream.arriving(f, i, x, y) += (a.even - b.even) + (a.odd - b.odd);
    stream.arriving(f, i + 1, x, y) += (a.even - b.even) - (a.odd - b.odd);
  });
}

void MarkedBodies::before_sweep(std::span<const Disc> discs, Populations& f,
                                const EsotericPull& stream) {
  bodies_.resize(discs.size());
  loads_.assign(discs.size(), DiscLoad{});
  // All bodies see the same fluid, so their order plays no part.
  std::unordered_map<std::int32_t, Vec2> seen, total;
  const auto velocity_at = [&](std::int32_t cell) {
    const auto found = seen.find(cell);
    return found != seen.end() ? found->second
                               : seen.emplace(cell, velocity(cell, f, stream)).first->second;
  };
  for (std::size_t d = 0; d < discs.size(); ++d) {
    Body& body = bodies_[d];
    const bool same = body.disc.id == discs[d].id && body.disc.centre == discs[d].centre &&
                      body.disc.radius == discs[d].radius && !body.markers.empty();
    body.disc = discs[d];
    if (!same) {
      mark(body);
      moved(body);
    }
    std::vector<Vec2> slip;
    for (const Marker& m : body.markers) {
      Vec2 u(0.0, 0.0);
      for (const Reach& r : m.reach) u += r.weight * velocity_at(r.cell);
      slip.push_back(wall_velocity(body.disc, m.arm) - u);
    }
    const std::vector<Vec2> change = changes(body, slip);
    for (std::size_t k = 0; k < body.markers.size(); ++k)
      for (const Reach& r : body.markers[k].reach) {
        const Vec2 du = body.element * r.weight * change[k];
        total.try_emplace(r.cell, 0.0, 0.0).first->second += du;
        double rho = 1.0;
        for (int q = 0; q < D2Q9::Q; ++q)
          rho += stream.arriving(f, q, r.cell % domain_.nx, r.cell / domain_.nx);
        const Vec2 force = -rho * du;
        loads_[d].force += force;
        const Vec2& arm = body.markers[k].arm;
        loads_[d].torque += arm.x() * force.y() - arm.y() * force.x();
      }
  }
  for (const auto& [cell, change] : total) shift(cell, change, f, stream);
}

void ImplicitMarkers::moved(const Body& body) {
  const auto n = static_cast<Eigen::Index>(body.markers.size());
  Eigen::MatrixXd a = Eigen::MatrixXd::Zero(n, n);
  std::unordered_map<std::int32_t, std::vector<std::pair<Eigen::Index, double>>> cells;
  for (Eigen::Index k = 0; k < n; ++k)
    for (const Reach& r : body.markers[k].reach) cells[r.cell].emplace_back(k, r.weight);
  for (const auto& [cell, markers] : cells)
    for (const auto& [k, wk] : markers)
      for (const auto& [j, wj] : markers) a(k, j) += body.element * wk * wj;
  systems_[body.disc.id].compute(a);
}

std::vector<Vec2> ImplicitMarkers::changes(const Body& body, const std::vector<Vec2>& slip) {
  Eigen::MatrixXd right(slip.size(), 2);
  for (std::size_t k = 0; k < slip.size(); ++k) right.row(k) = slip[k].transpose();
  const Eigen::MatrixXd half = systems_.at(body.disc.id).solve(right);
  std::vector<Vec2> change;
  for (std::size_t k = 0; k < slip.size(); ++k) change.emplace_back(2.0 * half.row(k).transpose());
  return change;
}

std::vector<Vec2> SpringMarkers::changes(const Body& body, const std::vector<Vec2>& slip) {
  std::vector<Vec2>& stretch = stretch_[body.disc.id];
  stretch.resize(slip.size(), Vec2(0.0, 0.0));
  std::vector<Vec2> change;
  for (std::size_t k = 0; k < slip.size(); ++k) {
    stretch[k] -= slip[k];
    change.emplace_back(-parameters_.spring_stiffness * stretch[k]);
  }
  return change;
}

std::vector<double> SpringMarkers::memory() const {
  std::vector<double> memory;
  for (const auto& [id, stretch] : stretch_) {
    memory.insert(memory.end(), {static_cast<double>(id), static_cast<double>(stretch.size())});
    for (const Vec2& s : stretch) memory.insert(memory.end(), {s.x(), s.y()});
  }
  return memory;
}

void SpringMarkers::restore(const std::vector<double>& memory) {
  stretch_.clear();
  for (std::size_t i = 0; i + 1 < memory.size();) {
    std::vector<Vec2>& stretch = stretch_[static_cast<std::int64_t>(memory[i])];
    const auto count = static_cast<std::size_t>(memory[i + 1]);
    i += 2;
    for (std::size_t k = 0; k < count && i + 1 < memory.size(); ++k, i += 2)
      stretch.emplace_back(memory[i], memory[i + 1]);
  }
}

}  // namespace lbm
