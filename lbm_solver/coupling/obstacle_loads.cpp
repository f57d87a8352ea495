// SPDX-License-Identifier: GPL-2.0-or-later
#include "lbm_solver/coupling/obstacle_loads.h"

namespace lbm {

ObstacleLoads::ObstacleLoads(const Scene& scene, const Plan& plan, const Decomposition& ranks,
                             const std::string& folder, double keep_until)
    : units_(plan.units), ranks_(ranks), boxes_(obstacle_blocks(scene, plan)) {
  const bool flat = scene.box.dimension == 2;
  if (ranks.rank() == 0)
    table_.emplace(folder + "/obstacles.csv",
                   flat ? "time [s],obstacle [1],fx [N],fy [N],torque [N m]"
                        : "time [s],obstacle [1],fx [N],fy [N],fz [N],tx [N m],ty [N m],tz [N m]",
                   keep_until);
  int lines = 0;
  for (const ObstacleScene& o : scene.obstacles) {
    has_grains_ = has_grains_ || o.grain;
    (o.body() ? line_ : o.block() ? block_line_ : shape_line_).push_back(o.grain ? 0 : ++lines);
    if (o.motion && ranks.rank() == 0) movers_.push_back({lines, InnerFluid(plan, o)});
    if (!o.body()) continue;
    motions_.push_back(o.motion);
    centres_.push_back(units_.to_lattice_position(o.centre));
  }
  sums_.resize(lines + 1);
}

void ObstacleLoads::add(Fluid& fluid, std::span<const BodyLoad> bodies) {
  const auto add_to = [this](int line, const BodyLoad& load) {
    sums_[line].force += load.force;
    sums_[line].torque += load.torque;
  };
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    add_to(line_[i], bodies[i]);
    if (!motions_[i]) continue;
    const Vec3 arm = arm_of(i, fluid.steps() - 1);
    sums_[line_[i]].torque += arm.cross(bodies[i].force);
  }
  if (!boxes_.empty()) {
    if (!blocks_) blocks_.emplace(fluid, boxes_);
    const std::vector<BodyLoad> loads = blocks_->loads();
    const std::vector<int>& cells = blocks_->cells();
    for (std::size_t i = 0; i < loads.size(); ++i) {
      // as a pressure gradient would: on the fluid that its cells do not hold, too
      const Vec3 force = loads[i].force + cells[i] * fluid.body_force();
      add_to(block_line_[i], {force, loads[i].torque});
    }
  }
  const std::vector<BodyLoad> shapes = fluid.fixed_loads();
  for (std::size_t i = 0; i < shapes.size(); ++i) add_to(shape_line_[i], shapes[i]);
  for (const Mover& mover : movers_) add_to(mover.line, mover.inner.in_step(fluid.steps() - 1));
  ++steps_;
}

/// From the pivot of a body that moves to its centre.
Vec3 ObstacleLoads::arm_of(std::size_t body, std::int64_t step) const {
  const Pose pose = pose_in_cells(units_, *motions_[body], step);
  return pose.moved(centres_[body]) - pose.centre();
}

/// The sums of all ranks.
std::vector<BodyLoad> ObstacleLoads::whole() const {
  std::vector<double> parts;
  for (const BodyLoad& s : sums_)
    for (const Vec3* v : {&s.force, &s.torque}) parts.insert(parts.end(), v->begin(), v->end());
  ranks_.sum(parts);
  std::vector<BodyLoad> all(sums_.size());
  for (std::size_t i = 0; i < all.size(); ++i) {
    all[i].force = {parts[6 * i], parts[6 * i + 1], parts[6 * i + 2]};
    all[i].torque = {parts[6 * i + 3], parts[6 * i + 4], parts[6 * i + 5]};
  }
  return all;
}

void ObstacleLoads::write(double time) {
  if (steps_ == 0) return;
  const std::vector<BodyLoad> all = whole();
  for (std::size_t i = has_grains_ ? 0 : 1; table_ && i < all.size(); ++i) {
    const Vec3 force = all[i].force * (units_.force() / steps_);
    const Vec3 torque = all[i].torque * (units_.torque() / steps_);
    const auto number = static_cast<double>(i);
    if (ranks_.domain().dimension() == 2)
      table_->row({time, number, force.x(), force.y(), torque.z()});
    else
      table_->row(
          {time, number, force.x(), force.y(), force.z(), torque.x(), torque.y(), torque.z()});
  }
  if (table_) table_->flush();
  sums_.assign(sums_.size(), BodyLoad{});
  steps_ = 0;
}

Record ObstacleLoads::save() const {
  std::vector<double> sums;
  for (const BodyLoad& sum : sums_)
    for (const Vec3* v : {&sum.force, &sum.torque}) sums.insert(sums.end(), v->begin(), v->end());
  Record record;
  record.set("steps", std::int64_t{steps_});
  record.set("force_and_torque_sums", ranks_.collect_parts(sums));
  return record;
}

void ObstacleLoads::load(const Record& record) {
  const std::vector<double> sums =
      ranks_.own_part(record.get<std::vector<double>>("force_and_torque_sums"), 6 * sums_.size());
  steps_ = static_cast<int>(record.integer("steps"));
  for (std::size_t i = 0; i < sums_.size(); ++i) {
    const double* v = &sums[6 * i];
    sums_[i] = {{v[0], v[1], v[2]}, {v[3], v[4], v[5]}};
  }
}

}  // namespace lbm
