// SPDX-License-Identifier: GPL-2.0-or-later
#include "lbm_solver/coupling/obstacle_loads.h"

namespace lbm {

ObstacleLoads::ObstacleLoads(const Scene& scene, const Plan& plan, const std::string& folder,
                             double keep_until)
    : units_(plan.units),
      table_(folder + "/obstacles.csv", "time,obstacle,fx,fy,torque", keep_until) {
  int lines = 0;
  for (const ObstacleScene& o : scene.obstacles) {
    if (!o.disc) continue;
    has_grains_ = has_grains_ || o.grain;
    line_.push_back(o.grain ? 0 : ++lines);
  }
  sums_.resize(lines + 1);
}

void ObstacleLoads::add(std::span<const DiscLoad> loads) {
  for (std::size_t i = 0; i < loads.size(); ++i) {
    sums_[line_[i]].force += loads[i].force;
    sums_[line_[i]].torque += loads[i].torque;
  }
  ++steps_;
}

void ObstacleLoads::write(double time) {
  if (steps_ == 0) return;
  const double force = units_.force() / steps_;
  for (std::size_t i = has_grains_ ? 0 : 1; i < sums_.size(); ++i)
    table_.row({time, static_cast<double>(i), sums_[i].force.x() * force,
                sums_[i].force.y() * force, sums_[i].torque * force * units_.dx});
  table_.flush();
  sums_.assign(sums_.size(), DiscLoad{});
  steps_ = 0;
}

std::vector<double> ObstacleLoads::state() const {
  std::vector<double> s{static_cast<double>(steps_)};
  for (const DiscLoad& sum : sums_) s.insert(s.end(), {sum.force.x(), sum.force.y(), sum.torque});
  return s;
}

void ObstacleLoads::restore(std::span<const double> s) {
  steps_ = static_cast<int>(s[0]);
  for (std::size_t i = 0; i < sums_.size(); ++i)
    sums_[i] = {{s[1 + 3 * i], s[2 + 3 * i]}, s[3 + 3 * i]};
}

}  // namespace lbm
