// SPDX-License-Identifier: GPL-2.0-or-later
#include "lbm_solver/coupling/steady_watch.h"

#include <algorithm>
#include <cmath>
#include <span>

namespace lbm {

SteadyWatch::SteadyWatch(const Scene& scene, const Plan& plan, std::int64_t steps_between_looks)
    : limit_(scene.steady_below) {
  const double turnover = std::max({plan.domain.nx, plan.domain.ny, plan.domain.nz}) *
                          plan.lattice_speed / scene.fluid.velocity_scale;  // steps
  looks_a_turnover_ = turnover / static_cast<double>(steps_between_looks);
}

void SteadyWatch::look(Fluid& fluid) {
  const Cell3& n = fluid.cells().size;
  const auto nx = static_cast<std::size_t>(n[0]), rows = static_cast<std::size_t>(n[1]) * n[2];
  std::vector<double> rho(nx), now(3 * nx * rows), u[3];
  for (auto& component : u) component.resize(nx);
  for (std::size_t r = 0; r < rows; ++r) {
    fluid.row(static_cast<int>(r) % n[1], static_cast<int>(r) / n[1], rho, {u[0], u[1], u[2]});
    for (std::size_t x = 0; x < nx; ++x)
      for (std::size_t k = 0; k < 3; ++k) now[3 * (nx * r + x) + k] = u[k][x];
  }
  double largest = 0.0, change = 0.0;
  for (std::size_t i = 0; i < now.size(); ++i) {
    largest = std::max(largest, std::abs(now[i]));
    if (!before_.empty()) change = std::max(change, std::abs(now[i] - before_[i]));
  }
  largest = fluid.ranks().max(largest);
  change = fluid.ranks().max(change);
  steady_ = !before_.empty() && largest > 0.0 && change / largest * looks_a_turnover_ < limit_;
  before_ = std::move(now);
}

Record SteadyWatch::save(const Decomposition& ranks) const {
  Record record;
  record.set("steady", std::int64_t{steady_});
  record.set("looked", std::int64_t{!before_.empty()});
  if (!before_.empty()) record.set("velocities", ranks.values_of(before_, 3));
  return record;
}

void SteadyWatch::load(const Record& record, const Decomposition& ranks) {
  steady_ = record.integer("steady") != 0;
  before_.clear();
  if (record.integer("looked") == 0) return;
  before_ = ranks.own_values(record.cells("velocities", ranks.domain().cells(), 3));
}

}  // namespace lbm
