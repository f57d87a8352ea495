// SPDX-License-Identifier: GPL-2.0-or-later
#include "lbm_solver/solver/motion_check.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "lbm_solver/base/errors.h"
#include "lbm_solver/solver/table_check.h"

namespace lbm {
namespace {

constexpr int kLooks = 500;             // times at which a way is looked at
constexpr double kAcrossItself = 0.05;  // part of a surface's speed that may cross it
// Beyond a side LIGGGHTS looks for triangles within their reach and half of its cut-off, with what
// moves in between: 0.6 diameters at a skin of 0.1, more where contacts act at a distance.
constexpr double kLayerRoom = 0.75;  // diameters
constexpr double kThinLayer = 0.1;   // diameters that are then left for a triangle

/// Places that hold an obstacle between them, at rest.
std::vector<Vec3> corners(const Scene& s, const ObstacleScene& o) {
  if (!o.round) return o.mesh->surface->vertices;
  const double r = 0.5 * o.diameter;
  std::vector<Vec3> places;
  for (int k = 0; k < s.box.dimension; ++k)
    for (const double side : {-r, r}) {
      Vec3 place = o.centre;
      place[k] += side;
      places.push_back(place);
    }
  return places;
}

/// The first time at which an obstacle lies outside of the box across a wall; negative: never.
double leaves_at(const Scene& s, const ObstacleScene& o) {
  const std::vector<Vec3> places = corners(s, o);
  for (int look = 1; look <= kLooks; ++look) {
    const double time = s.end_time * look / kLooks;
    const Pose pose = pose_at(*o.motion, time);
    Vec3 low = pose.moved(places[0]), high = low;
    for (const Vec3& place : places) {
      const Vec3 now = pose.moved(place);
      low = low.cwiseMin(now);
      high = high.cwiseMax(now);
    }
    for (int k = 0; k < s.box.dimension; ++k)
      if (s.box.sides[k] == SideKind::Wall &&
          (high[k] <= s.box.origin[k] || low[k] >= s.box.origin[k] + s.box.size[k]))
        return time;
  }
  return -1.0;
}

struct Beyond {
  double time;
  int side;  ///< of the box
};

/// When the middle of a triangle first lies beyond a wall of the box.
std::optional<Beyond> part_leaves(const Scene& s, const ObstacleScene& o) {
  const TriangleMesh& mesh = *o.mesh->surface;
  std::vector<Vec3> middles;
  for (const auto& t : mesh.triangles)
    middles.push_back((mesh.vertices[t[0]] + mesh.vertices[t[1]] + mesh.vertices[t[2]]) / 3.0);
  for (int look = 0; look <= kLooks; ++look) {
    const double time = s.end_time * look / kLooks;
    const Pose pose = pose_at(*o.motion, time);
    for (const Vec3& middle : middles) {
      const Vec3 now = pose.moved(middle) - s.box.origin;
      for (int k = 0; k < s.box.dimension; ++k) {
        if (s.box.sides[k] != SideKind::Wall) continue;
        const double near = 1e-9 * s.box.size[k];
        if (now[k] < -near) return Beyond{time, 2 * k};
        if (now[k] > s.box.size[k] + near) return Beyond{time, 2 * k + 1};
      }
    }
  }
  return std::nullopt;
}

/// What LIGGGHTS would stop at, without saying why.
void check_for_liggghts(const Scene& s, const ObstacleScene& o, std::size_t number, Plan& plan) {
  if (o.motion->surface_only) return;
  if (const auto beyond = part_leaves(s, o))
    plan.warnings.push_back(fmt::format(
        "the {}. obstacle reaches through the wall \"{}\" at {:.4g} s: LIGGGHTS stops there (a "
        "mesh \"left the domain\"), and grains between the two are crushed; keep it within the box "
        "all along its way",
        number, kSideNames[beyond->side], beyond->time));
  if (const double d = s.particles->diameter.hi;
      s.box.dimension == 2 && reach_in_layer(s) < kThinLayer * d)
    plan.warnings.push_back(fmt::format(
        "box.depth = {:.4g} m is too thin for the {}. obstacle, which moves: LIGGGHTS repeats the "
        "layer and stops (\"assertion failed\") where grains of {:.4g} m reach through it to the "
        "next but one; take a depth of at least {:.4g} m, loads and masses grow with it alike",
        s.box.depth, number, d, d));
}

/// Part of the surface's velocity that crosses it, where it has one.
double across_itself(const ObstacleScene& o) {
  const Pose pose = pose_at(*o.motion, 0.0);
  if (o.round) return pose.velocity_at(o.centre).isZero(1e-12) ? 0.0 : 1.0;
  const TriangleMesh& mesh = *o.mesh->surface;
  double across = 0.0, all = 0.0;
  for (const auto& t : mesh.triangles) {
    const Vec3 middle = (mesh.vertices[t[0]] + mesh.vertices[t[1]] + mesh.vertices[t[2]]) / 3.0;
    const Vec3 velocity = pose.velocity_at(middle), area = mesh.area_vector(t);
    across += std::abs(velocity.dot(area));
    all += velocity.norm() * area.norm();
  }
  return all > 0.0 ? across / all : 0.0;
}

/// Why LIGGGHTS' fix move/mesh cannot follow; empty where it can.
std::string why_not_in_liggghts(const MotionScene& m) {
  if (m.kind == MotionScene::Kind::Table) return "moves as a table says";
  if (m.kind != MotionScene::Kind::Oscillation) return {};
  if (m.surface_only) return "oscillates in its surface";
  if (!m.amplitude.isZero(0.0) && m.angular_amplitude != 0.0)
    return "oscillates to and fro and about an axis at once";
  return {};
}

void check_motion(const Scene& s, const ObstacleScene& o, std::size_t number, Plan& plan) {
  const MotionScene& m = *o.motion;
  const auto warn = [&](const std::string& text) {
    plan.warnings.push_back(fmt::format("the {}. obstacle {}", number, text));
  };
  if (const std::string why = why_not_in_liggghts(m); s.coupling && o.mesh && !why.empty())
    throw InputError(
        fmt::format("{}: the {}. obstacle {}, which the fix move/mesh of the solid program cannot "
                    "follow: grains and fluid would meet two walls",
                    s.file, number, why),
        "take a motion that is linear, a rotation, or one oscillation");
  if (s.coupling && o.mesh) check_for_liggghts(s, o, number, plan);
  if (!m.times.empty() && m.times.front() > 0.0)
    warn(fmt::format("has a motion_table that begins at {:.4g} s: it stands until then",
                     m.times.front()));
  if (!m.times.empty() && m.times.back() < s.end_time * (1.0 - 1e-9))
    warn(
        fmt::format("has a motion_table that ends at {:.4g} s, the run at {:.4g} s: it stands "
                    "from then on",
                    m.times.back(), s.end_time));
  if (!m.times.empty())
    if (const std::string odd = odd_times(m.times, false, s.end_time); !odd.empty())
      warn("has a motion_table that " + odd);
  for (int k = 0; k < s.box.dimension && o.drum(); ++k) {
    const double wall = 0.5 * o.diameter + kDrumWall * plan.units.dx;
    if (s.box.sides[k] == SideKind::Wall &&
        (o.centre[k] - wall < s.box.origin[k] ||
         o.centre[k] + wall > s.box.origin[k] + s.box.size[k])) {
      warn(
          fmt::format("is a drum, whose wall of {} cells reaches the sides of the box and rubs "
                      "there: leave {} cells around it",
                      kDrumWall, kDrumWall + 1.0));
      break;
    }
  }
  if (m.surface_only) {
    if (const double part = across_itself(o); part > kAcrossItself)
      warn(
          fmt::format("moves its surface only, which does not move along itself ({:.2g} of its "
                      "velocity crosses it): fluid would pass through; leave surface_only out",
                      part));
  } else if (const double time = leaves_at(s, o); time > 0.0 && !o.hollow) {
    warn(fmt::format("has left the box at {:.4g} s", time));
  }
}

}  // namespace

double reach_in_layer(const Scene& s) {
  return s.box.depth - kLayerRoom * s.particles->diameter.hi;
}

double reach_of(const ObstacleScene& o) {
  if (!o.motion) return 0.0;
  const auto distance = [&](const Vec3& place) {
    return o.motion->axis.cross(Vec3(place - o.motion->about)).norm();
  };
  if (o.round) return distance(o.centre) + 0.5 * o.diameter;
  double reach = 0.0;
  for (const Vec3& v : o.mesh->surface->vertices) reach = std::max(reach, distance(v));
  return reach;
}

std::string fastest_part(const ObstacleScene& o, double end) {
  const MotionScene& m = *o.motion;
  const double reach = reach_of(o);
  double largest = 0.0;
  std::string part;
  for (std::size_t k = 1; k < m.times.size() && m.times[k - 1] < end; ++k) {
    const double way =
        (m.shifts[k] - m.shifts[k - 1]).norm() + std::abs(m.angles[k] - m.angles[k - 1]) * reach;
    const double speed = way / (m.times[k] - m.times[k - 1]);
    if (speed <= largest) continue;
    largest = speed;
    part = fmt::format(" in lines {} and {} of its motion_table ({:.6g} and {:.6g} s)", k + 1,
                       k + 2, m.times[k - 1], m.times[k]);
  }
  return part;
}

void check_motions(const Scene& s, Plan& plan) {
  for (std::size_t i = 0; i < s.obstacles.size(); ++i)
    if (s.obstacles[i].motion) check_motion(s, s.obstacles[i], i + 1, plan);
}

}  // namespace lbm
