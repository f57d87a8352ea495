// SPDX-License-Identifier: GPL-2.0-or-later
#include "lbm_solver/coupling/inner_fluid.h"

namespace lbm {

InnerFluid::InnerFluid(const Plan& plan, const ObstacleScene& o)
    : units_(plan.units), motion_(*o.motion) {
  if (o.hollow || (o.mesh && o.mesh->hollow)) return;
  const int d = plan.domain.dimension();
  const Vec3 pivot = units_.to_lattice_position(motion_.about);
  if (o.round) {
    moments_ = moments_in_ball(units_.to_lattice_position(o.centre), 0.5 * o.diameter / units_.dx,
                               d, pivot);
    return;
  }
  TriangleMesh mesh = *o.mesh->surface;
  for (Vec3& v : mesh.vertices) {
    const bool upper = v.z() > 0.0;
    v = units_.to_lattice_position(v);
    if (d == 2) v.z() = upper ? 0.5 : -0.5;  // a layer of thickness 1
  }
  moments_ = moments_in(mesh, pivot);
  if (d == 3) return;
  moments_.first.z() = 0.0;
  moments_.second.row(2).setZero();
  moments_.second.col(2).setZero();
}

BodyLoad InnerFluid::momentum(const Pose& pose) const {
  const Eigen::Matrix3d turn = pose.angle == 0.0
                                   ? Eigen::Matrix3d(Eigen::Matrix3d::Identity())
                                   : Eigen::AngleAxisd(pose.angle, pose.axis).toRotationMatrix();
  const Vec3 first = turn * moments_.first;
  const Eigen::Matrix3d second = turn * moments_.second * turn.transpose();
  const Vec3& w = pose.spin;
  return {moments_.volume * pose.velocity + w.cross(first),
          first.cross(pose.velocity) + second.trace() * w - second * w};
}

BodyLoad InnerFluid::in_step(std::int64_t step) const {
  if (moments_.volume == 0.0) return {};
  const Pose pose = pose_in_cells(units_, motion_, step);
  const BodyLoad now = momentum(pose), then = momentum(pose_in_cells(units_, motion_, step + 1));
  return {then.force - now.force, then.torque - now.torque + pose.velocity.cross(now.force)};
}

}  // namespace lbm
