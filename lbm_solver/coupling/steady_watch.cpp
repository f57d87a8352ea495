// SPDX-License-Identifier: GPL-2.0-or-later
#include "lbm_solver/coupling/steady_watch.h"

#include <algorithm>
#include <cmath>
#include <span>

namespace lbm {

SteadyWatch::SteadyWatch(const Scene& scene, const Plan& plan, std::int64_t steps_between_looks)
    : domain_(plan.domain), limit_(scene.steady_below) {
  const double turnover = std::max(plan.domain.nx, plan.domain.ny) * plan.lattice_speed /
                          scene.fluid.velocity_scale;  // steps
  looks_a_turnover_ = turnover / static_cast<double>(steps_between_looks);
}

void SteadyWatch::look(Fluid& fluid) {
  const int nx = domain_.nx, ny = domain_.ny;
  std::vector<double> rho(nx), now(2 * static_cast<std::size_t>(nx) * ny);
  double largest = 0.0, change = 0.0;
  for (int y = 0; y < ny; ++y) {
    const std::span row(now.data() + 2 * static_cast<std::size_t>(nx) * y, 2 * nx);
    fluid.row(y, rho, row.first(nx), row.last(nx));
  }
  for (std::size_t i = 0; i < now.size(); ++i) {
    largest = std::max(largest, std::abs(now[i]));
    if (!before_.empty()) change = std::max(change, std::abs(now[i] - before_[i]));
  }
  steady_ = !before_.empty() && largest > 0.0 && change / largest * looks_a_turnover_ < limit_;
  before_ = std::move(now);
}

}  // namespace lbm
