// SPDX-License-Identifier: GPL-2.0-or-later
#include "lbm_solver/immersed/marked_bodies.h"

#include <cmath>
#include <numbers>
#include <unordered_map>

#include "lbm_solver/field/cell_pass.h"

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

void MarkedBodies::add_reach(Marker& marker, const Vec3& place) const {
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

void MarkedBodies::mark(Marked& marked) const {
  const double length = 2.0 * std::numbers::pi * marked.body.radius;
  const int count = std::max(4, static_cast<int>(length / kSpacing));
  marked.element = length / count;
  marked.markers.assign(count, {});
  for (int k = 0; k < count; ++k) {
    const double angle = 2.0 * std::numbers::pi * k / count;
    Marker& m = marked.markers[k];
    m.arm = marked.body.radius * Vec3(std::cos(angle), std::sin(angle));
    add_reach(m, marked.body.centre + m.arm);
  }
}

Vec3 MarkedBodies::velocity(std::int32_t cell, const Populations& f,
                            const EsotericPull& stream) const {
  const CellMoments m = cell_moments(f, stream, cell % domain_.nx, cell / domain_.nx, 0);
  return (m.j + 0.5 * body_force_) / (1.0 + m.drho);
}

void MarkedBodies::shift(std::int32_t cell, const Vec3& change, Populations& f,
                         const EsotericPull& stream) const {
  const int x = cell % domain_.nx, y = cell / domain_.nx;
  const CellMoments m = cell_moments(f, stream, x, y, 0);
  const Vec3 u = m.velocity(), to = u + change;
  const Lattice& l = f.lattice();
  for (int q = 0; q < l.Q; ++q)
    stream.arriving(f, q, x, y) += equilibrium(l, q, m.drho, to) - equilibrium(l, q, m.drho, u);
}

void MarkedBodies::before_sweep(std::span<const Body> bodies, Populations& f,
                                const EsotericPull& stream) {
  marked_.resize(bodies.size());
  loads_.assign(bodies.size(), BodyLoad{});
  // All bodies see the same fluid, so their order plays no part.
  std::unordered_map<std::int32_t, Vec3> seen, total;
  const auto velocity_at = [&](std::int32_t cell) {
    const auto found = seen.find(cell);
    return found != seen.end() ? found->second
                               : seen.emplace(cell, velocity(cell, f, stream)).first->second;
  };
  for (std::size_t d = 0; d < bodies.size(); ++d) {
    Marked& marked = marked_[d];
    const bool same = marked.body.id == bodies[d].id && marked.body.centre == bodies[d].centre &&
                      marked.body.radius == bodies[d].radius && !marked.markers.empty();
    marked.body = bodies[d];
    if (!same) {
      mark(marked);
      moved(marked);
    }
    std::vector<Vec3> slip;
    for (const Marker& m : marked.markers) {
      Vec3 u;
      for (const Reach& r : m.reach) u += r.weight * velocity_at(r.cell);
      slip.push_back(marked.body.velocity_at(m.arm) - u);
    }
    const std::vector<Vec3> change = changes(marked, slip);
    for (std::size_t k = 0; k < marked.markers.size(); ++k)
      for (const Reach& r : marked.markers[k].reach) {
        const Vec3 du = marked.element * r.weight * change[k];
        total.try_emplace(r.cell).first->second += du;
        const double rho =
            1.0 + cell_moments(f, stream, r.cell % domain_.nx, r.cell / domain_.nx, 0).drho;
        loads_[d].add(-rho * du, marked.markers[k].arm);
      }
  }
  for (const auto& [cell, change] : total) shift(cell, change, f, stream);
}

void ImplicitMarkers::moved(const Marked& marked) {
  const auto n = static_cast<Eigen::Index>(marked.markers.size());
  Eigen::MatrixXd a = Eigen::MatrixXd::Zero(n, n);
  std::unordered_map<std::int32_t, std::vector<std::pair<Eigen::Index, double>>> cells;
  for (Eigen::Index k = 0; k < n; ++k)
    for (const Reach& r : marked.markers[k].reach) cells[r.cell].emplace_back(k, r.weight);
  for (const auto& [cell, markers] : cells)
    for (const auto& [k, wk] : markers)
      for (const auto& [j, wj] : markers) a(k, j) += marked.element * wk * wj;
  systems_[marked.body.id].compute(a);
}

std::vector<Vec3> ImplicitMarkers::changes(const Marked& marked, const std::vector<Vec3>& slip) {
  Eigen::MatrixXd right(slip.size(), 3);
  for (std::size_t k = 0; k < slip.size(); ++k) right.row(k) = slip[k].transpose();
  const Eigen::MatrixXd half = systems_.at(marked.body.id).solve(right);
  std::vector<Vec3> change;
  for (std::size_t k = 0; k < slip.size(); ++k) change.emplace_back(2.0 * half.row(k).transpose());
  return change;
}

std::vector<Vec3> SpringMarkers::changes(const Marked& marked, const std::vector<Vec3>& slip) {
  std::vector<Vec3>& stretch = stretch_[marked.body.id];
  stretch.resize(slip.size(), Vec3());
  std::vector<Vec3> change;
  for (std::size_t k = 0; k < slip.size(); ++k) {
    stretch[k] -= slip[k];
    change.emplace_back(-stiffness_ * stretch[k]);
  }
  return change;
}

std::vector<double> SpringMarkers::memory() const {
  std::vector<double> memory;
  for (const auto& [id, stretch] : stretch_) {
    memory.insert(memory.end(), {static_cast<double>(id), static_cast<double>(stretch.size())});
    for (const Vec3& s : stretch) memory.insert(memory.end(), {s.x(), s.y()});
  }
  return memory;
}

void SpringMarkers::restore(const std::vector<double>& memory) {
  stretch_.clear();
  for (std::size_t i = 0; i + 1 < memory.size();) {
    std::vector<Vec3>& stretch = stretch_[static_cast<std::int64_t>(memory[i])];
    const auto count = static_cast<std::size_t>(memory[i + 1]);
    i += 2;
    for (std::size_t k = 0; k < count && i + 1 < memory.size(); ++k, i += 2)
      stretch.emplace_back(memory[i], memory[i + 1]);
  }
}

}  // namespace lbm
