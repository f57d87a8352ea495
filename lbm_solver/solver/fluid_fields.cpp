// SPDX-License-Identifier: GPL-2.0-or-later
/// What a fluid shows of itself: moments of cells and rows, what solids cover, extremes.
#include <algorithm>
#include <cmath>
#include <limits>

#include "lbm_solver/immersed/solid_fraction.h"
#include "lbm_solver/solver/fluid.h"

namespace lbm {
namespace {

/// From a body's centre, or that of its nearest image, to the centre of a cell.
Vec3 arm_to(const Body& body, const Domain& domain, int x, int y, int z) {
  const Vec3 centre(x + 0.5, y + 0.5, domain.dimension() == 3 ? z + 0.5 : 0.0);
  return domain.nearest_image(centre - body.centre);
}

/// Part of the cell at the end of the arm that the body covers.
double fraction_at(const Body& body, const Domain& domain, const Vec3& arm) {
  const double fraction = domain.dimension() == 3
                              ? sphere_fraction(arm.x(), arm.y(), arm.z(), body.radius)
                              : disc_fraction(arm.x(), arm.y(), body.radius);
  return body.hollow ? 1.0 - fraction : fraction;
}

}  // namespace

double Fluid::solid_fraction(int x, int y, int z) const {
  double sum = cover_ ? cover_->solid_fraction(x, y, z) : 0.0;
  if (!scheme_) return sum;
  for (const Body& body : bodies_)
    sum += fraction_at(body, domain(), arm_to(body, domain(), x, y, z));
  return std::min(1.0, sum);
}

Fluid::Cell Fluid::cell(int x, int y, int z) const {
  const CellMoments m = cell_moments(f_, stream_, x, y, z);
  return {m.drho + 1.0, (m.j + 0.5 * body_force()) / (m.drho + 1.0)};
}

Vec3 Fluid::arrived_momentum(int x, int y, int z) const {
  return cell_moments(f_, stream_, x, y, z).j;
}

Fluid::Cell Fluid::at(const Vec3& place) {
  int low[3];
  double part[3];
  for (int a = 0; a < 3; ++a) {
    const int n = domain().cells()[a];
    const double inside = std::clamp(place[a] - 0.5, 0.0, static_cast<double>(n - 1));
    low[a] = std::min(static_cast<int>(inside), std::max(0, n - 2));
    part[a] = n > 1 ? inside - low[a] : 0.0;
  }
  const auto nx = static_cast<std::size_t>(cells().size[0]);
  std::vector<double> rho(nx), solid(nx), u[3];
  for (auto& component : u) component.assign(nx, 0.0);
  double sum[5] = {0.0, 0.0, 0.0, 0.0, 0.0};  // rho, velocity, weight of cells without fluid
  for (int corner = 0; corner < (1 << domain().dimension()); ++corner) {
    Cell3 at;
    double weight = 1.0;
    for (int a = 0; a < 3; ++a) {
      const int up = corner >> a & 1;
      at[a] = low[a] + up;
      weight *= up ? part[a] : 1.0 - part[a];
    }
    if (!cells().holds(at)) continue;
    const auto& b = cells().begin;
    moments(at[1] - b[1], at[2] - b[2], rho, {u[0], u[1], u[2]}, solid);
    const int x = at[0] - b[0];
    (solid[x] < 1.0 ? sum[0] : sum[4]) += weight * (solid[x] < 1.0 ? rho[x] : 1.0);
    for (int a = 0; a < 3; ++a) sum[1 + a] += weight * u[a][x];
  }
  ranks_->sum(sum);
  constexpr double none = std::numeric_limits<double>::quiet_NaN();
  const double fluid = 1.0 - sum[4];
  const double mean = sum[4] == 0.0 ? sum[0] : fluid > 1e-12 ? sum[0] / fluid : none;
  return {mean, {sum[1], sum[2], sum[3]}};
}

/// Where a body covers cells of a row whole, they move as it does.
void Fluid::cover_by(const Body& body, int y, int z, const RowVelocity& u,
                     std::span<double> solid) {
  const Vec3 row = arm_to(body, domain(), 0, y, z);
  if (!body.hollow && std::hypot(row.y(), row.z()) > body.radius) return;
  for (int x = 0; x < cells().size[0]; ++x) {
    const Vec3 arm = arm_to(body, domain(), x, y, z);
    if (fraction_at(body, domain(), arm) < kWhole) continue;
    const Vec3 velocity = body.velocity_at(arm);
    for (int a = 0; a < domain().dimension(); ++a) u[a][x] = velocity[a];
    solid[x] = 1.0;
  }
}

/// Density of what has arrived in a row, its velocity as it is shown, and the solid's share in it.
void Fluid::moments(int y, int z, std::span<double> rho, const RowVelocity& u,
                    std::span<double> solid) {
  row_moments(f_, stream_, y, z, medium_, rho, u, solid);
  if (!scheme_) return;
  for (const Body& body : bodies_) cover_by(body, y, z, u, solid);
}

void Fluid::row(int y, int z, std::span<double> rho, const RowVelocity& u) {
  std::vector<double> solid(rho.size());
  moments(y, z, rho, u, solid);
  for (std::size_t x = 0; x < rho.size(); ++x)
    if (solid[x] >= 1.0) rho[x] = std::numeric_limits<double>::quiet_NaN();
}

Fluid::Extremes Fluid::extremes() {
  const Cell3 n = cells().size, &begin = cells().begin;
  double largest = 0.0, excess = 0.0;
  Cell3 fastest = begin, broken{0, 0, 0};
  bool finite = true;
  std::vector<double> rho(n[0]), solid(n[0]), u[3];
  for (auto& component : u) component.assign(n[0], 0.0);
  for (int z = 0; z < n[2] && finite; ++z)
    for (int y = 0; y < n[1] && finite; ++y) {
      moments(y, z, rho, {u[0], u[1], u[2]}, solid);
      for (int x = 0; x < n[0] && finite; ++x) {
        const double speed2 = u[0][x] * u[0][x] + u[1][x] * u[1][x] + u[2][x] * u[2][x];
        excess += rho[x] - 1.0;
        const Cell3 here{x + begin[0], y + begin[1], z + begin[2]};
        if (!std::isfinite(rho[x] + speed2)) {
          finite = false;
          broken = here;
        } else if (speed2 > largest && solid[x] < 1.0) {
          largest = speed2;
          fastest = here;
        }
      }
    }
  // One line a rank: every rank draws the same conclusion from all of them.
  const Cell3& cell = finite ? fastest : broken;
  std::vector<double> lines = ranks_->collect({finite ? 1.0 : 0.0, std::sqrt(largest), excess,
                                               1.0 * cell[0], 1.0 * cell[1], 1.0 * cell[2]});
  ranks_->broadcast(lines);
  Extremes e;
  for (std::size_t i = 0; i < lines.size(); i += 6) {
    const double* line = &lines[i];
    const bool sound = line[0] == 1.0;
    e.mass_excess += line[2];
    if (!e.finite || (sound && line[1] <= e.max_speed)) continue;
    e.finite = sound;
    e.max_speed = line[1];
    e.cell = {static_cast<int>(line[3]), static_cast<int>(line[4]), static_cast<int>(line[5])};
  }
  return e;
}

}  // namespace lbm
