// SPDX-License-Identifier: GPL-2.0-or-later
#include "lbm_solver/coupling/clump_shapes.h"

#include <algorithm>

#include "lbm_solver/base/errors.h"
#include "protocol/wire/ball_union.h"

namespace lbm {
namespace {

/// Nearer to its centre than this part of a clump's radius, the centroid is taken to be there: a
/// solid finds its centre by sampling (LIGGGHTS), and its error must turn nothing.
constexpr double kOffCentre = 0.01;
constexpr double kAligned = 1e-6;  // of the longest arm: spheres on one line
/// Places in the frame are whole multiples of this part of a radius: what is measured does not
/// depend on how the clump stood when it came, on any rank and after any restart.
constexpr double kGrain = 1.0 / (1 << 20);

/// Axes that turn with the spheres, as columns: along the longest arm, towards the one that is
/// farthest from it, and across both. Around the line of spheres that lie on one the body is round.
Eigen::Matrix3d frame_of(std::span<const Sphere> spheres, bool flat) {
  Vec3 along, across;
  for (const Sphere& s : spheres)
    if (s.arm.norm() > along.norm() * (1.0 + kAligned)) along = s.arm;
  if (along.norm() == 0.0) return Eigen::Matrix3d::Identity();
  const Vec3 first = along / along.norm();
  for (const Sphere& s : spheres) {
    const Vec3 off = s.arm - first * first.dot(s.arm);
    if (off.norm() > across.norm() * (1.0 + kAligned)) across = off;
  }
  if (flat) across = Vec3(-first.y(), first.x());
  if (across.norm() < kAligned * along.norm()) across = Vec3(first.unitOrthogonal());
  Eigen::Matrix3d frame;
  frame.col(0) = first;
  frame.col(1) = across / across.norm();
  frame.col(2) = frame.col(0).cross(frame.col(1));
  return frame;
}

std::vector<double> radii_of(std::span<const Sphere> spheres) {
  std::vector<double> radii;
  for (const Sphere& s : spheres) radii.push_back(s.radius);
  return radii;
}

}  // namespace

ClumpShapes::Known ClumpShapes::measure(std::span<const Sphere> spheres,
                                        const Eigen::Matrix3d& frame) const {
  std::vector<protocol::Ball> balls;
  const double grain = kGrain * spheres.front().radius;
  for (const Sphere& s : spheres) {
    const Eigen::Array3d steps = (frame.transpose() * s.arm).array() / grain;
    const Eigen::Array3d at = steps.round() * grain;
    balls.push_back({0, {at.x(), at.y(), at.z()}, s.radius});
  }
  const protocol::UnionMoments m = protocol::moments_of_union(balls, flat_ ? 2 : 3, depth_);
  Known known;
  known.radii = radii_of(spheres);
  known.volume = m.volume;
  known.centroid = to_vec3(m.centroid);
  if (known.centroid.norm() < kOffCentre * protocol::bounding_radius(balls))
    known.centroid = Vec3();
  const auto& [xx, yy, zz, yz, zx, xy] = m.second;
  known.second << xx, xy, zx, xy, yy, yz, zx, yz, zz;
  return known;
}

ClumpShapes::Placed ClumpShapes::place(const protocol::Shape& clump,
                                       std::span<const Sphere> spheres) {
  const Eigen::Matrix3d frame = frame_of(spheres, flat_);
  Known& known = known_[clump.id];
  const auto same = [](const Sphere& s, double radius) { return s.radius == radius; };
  const bool as_before =
      known.epoch == clump.epoch && std::ranges::equal(spheres, known.radii, same);
  if (!as_before) {
    known = measure(spheres, frame);
    known.epoch = clump.epoch;
  }
  known.placed = true;
  const Eigen::Matrix3d second = frame * known.second * frame.transpose();
  return {known.volume,
          {frame * known.centroid, second.trace() * Eigen::Matrix3d::Identity() - second}};
}

void ClumpShapes::keep_placed() {
  std::erase_if(known_, [](const auto& entry) { return !entry.second.placed; });
  for (auto& [id, known] : known_) known.placed = false;
}

void expect_takes_clumps(SolidScheme scheme) {
  if (scheme != SolidScheme::ImplicitImmersedBoundary &&
      scheme != SolidScheme::SpringImmersedBoundary)
    return;
  throw InputError("numerics.scheme = " + name_of(scheme),
                   "cannot take the solid's clumps, whose spheres overlap",
                   "choose immersed_moving_boundary or bounce_back");
}

}  // namespace lbm
