// SPDX-License-Identifier: GPL-2.0-or-later
#include "lbm_solver/io/shown_obstacles.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "lbm_solver/io/hdf5_array.h"

namespace lbm {
namespace {

/// Edges around the upper end of a surface through the layer of a box in two dimensions.
std::vector<std::pair<std::uint32_t, std::uint32_t>> outline(const TriangleMesh& mesh) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> edges;
  for (const auto& t : mesh.triangles) {
    if (std::ranges::any_of(t, [&](auto k) { return mesh.vertices[k].z() <= 0.0; })) continue;
    for (int k = 0; k < 3; ++k) {
      const auto [low, high] = std::minmax(t[k], t[(k + 1) % 3]);
      ++edges[{low, high}];
    }
  }
  std::vector<std::pair<std::uint32_t, std::uint32_t>> rim;
  for (const auto& [edge, triangles] : edges)
    if (triangles == 1) rim.push_back(edge);
  return rim;
}

/// How a round obstacle turns, its surface alone too; nothing where it does not.
std::optional<MotionScene> turning(const ObstacleScene& o) {
  MotionScene turn;
  if (o.motion) {
    turn = *o.motion;
    turn.surface_only = false;
    const bool by_table = std::ranges::any_of(turn.angles, [](double a) { return a != 0.0; });
    if (turn.angular_velocity != 0.0 || turn.angular_amplitude != 0.0 || by_table) return turn;
    return {};
  }
  if (o.spin.z() == 0.0) return {};
  turn.kind = MotionScene::Kind::Rotation;
  turn.about = o.centre;
  turn.angular_velocity = o.spin.z();
  return turn;
}

std::string item(const std::string& path, const std::string& shape, const char* type) {
  return fmt::format("<DataItem Format=\"HDF\" {} Dimensions=\"{}\">fields.h5:/{}</DataItem>", type,
                     shape, path);
}
constexpr const char* kReal = "NumberType=\"Float\" Precision=\"8\"";
constexpr const char* kWhole = "NumberType=\"Int\" Precision=\"4\"";

}  // namespace

void ShownObstacles::Shapes::add(const std::vector<Vec3>& more,
                                 const std::optional<MotionScene>& motion) {
  Vec3 low = more.front(), high = more.front();
  for (const Vec3& p : more) {
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  parts.push_back({points.size(), points.size() + more.size(), 0.5 * (low + high), motion});
  points.insert(points.end(), more.begin(), more.end());
}

bool ShownObstacles::Shapes::move() const {
  return std::ranges::any_of(parts, [](const Part& part) { return part.motion.has_value(); });
}

ShownObstacles::ShownObstacles(const Scene& scene) : box_(scene.box) {
  for (std::size_t i = 0; i < scene.obstacles.size(); ++i) {
    const ObstacleScene& o = scene.obstacles[i];
    const double number = o.grain ? 0.0 : static_cast<double>(i + 1);
    const double radius = 0.5 * o.diameter;
    if (o.mesh) {
      add_surface(*o.mesh->surface, o.motion, number);
    } else if (o.block()) {
      const Vec3 thin(0.0, 0.0, box_.dimension == 2 ? 1.0 : 0.0);
      add_surface(box_surface(o.from - thin, o.to + thin), {}, number);
    } else if (o.round && o.hollow) {
      add_surface(round_surface(o.centre, radius, box_.dimension), o.motion, number);
    } else if (o.round) {
      round_.add({o.centre}, o.motion);
      round_.obstacle.push_back(number);
      radii_.push_back(radius);
    }
    if (o.round) add_mark(o, number);
  }
}

void ShownObstacles::add_cell(std::initializer_list<std::size_t> corners, double number) {
  for (const std::size_t k : corners) cells_.push_back(static_cast<int>(k));
  walls_.obstacle.push_back(number);
}

void ShownObstacles::add_surface(const TriangleMesh& mesh, const std::optional<MotionScene>& motion,
                                 double number) {
  const std::size_t first = walls_.points.size();
  if (box_.dimension == 3) {
    walls_.add(mesh.vertices, motion);
    for (const auto& [a, b, c] : mesh.triangles)
      add_cell({first + a, first + b, first + c}, number);
    return;
  }
  std::vector<Vec3> corners;
  std::map<std::uint32_t, std::size_t> place;
  for (const auto& [a, b] : outline(mesh)) {
    for (const auto k : {a, b}) {
      if (!place.emplace(k, first + corners.size()).second) continue;
      corners.emplace_back(mesh.vertices[k].x(), mesh.vertices[k].y(), 0.0);
    }
    add_cell({place[a], place[b]}, number);
  }
  walls_.add(corners, motion);
}

/// A line by which a disc that turns is seen to: in its outer half, of a hollow one in its wall.
void ShownObstacles::add_mark(const ObstacleScene& o, double number) {
  const auto turn = turning(o);
  if (box_.dimension != 2 || !turn) return;
  const std::size_t first = walls_.points.size();
  const Vec3 arm(0.5 * o.diameter, 0.0, 0.0);
  walls_.add({o.centre + arm, o.centre + (o.hollow ? 1.1 : 0.5) * arm}, turn);
  walls_.parts.back().middle = o.centre;
  add_cell({first, first + 1}, number);
}

/// Of all points, each moved as its part does; one that leaves through a periodic side comes back.
std::vector<double> ShownObstacles::places(const Shapes& shapes, double time) const {
  std::vector<double> numbers;
  for (const Part& part : shapes.parts) {
    const Pose pose = part.motion ? pose_at(*part.motion, time) : Pose();
    Vec3 back = Vec3::Zero();
    const Vec3 from_corner = pose.moved(part.middle) - box_.origin;
    for (int k = 0; part.motion && k < box_.dimension; ++k)
      if (box_.sides[k] == SideKind::Periodic)
        back[k] = -box_.size[k] * std::floor(from_corner[k] / box_.size[k]);
    for (std::size_t i = part.begin; i < part.end; ++i) {
      const Vec3 place = part.motion ? pose.moved(shapes.points[i]) + back : shapes.points[i];
      for (int k = 0; k < box_.dimension; ++k) numbers.push_back(place[k]);
    }
  }
  return numbers;
}

bool ShownObstacles::lie_in(hid_t first_frame) const {
  const auto has = [&](const char* name) { return H5Lexists(first_frame, name, H5P_DEFAULT) > 0; };
  return (!any_walls() || has("wall_cells")) && (!any_round() || has("round_radius"));
}

void ShownObstacles::write(hid_t group, double time, bool first) const {
  const auto d = static_cast<hsize_t>(box_.dimension);
  const auto number = [](const auto& list) { return static_cast<hsize_t>(list.size()); };
  if (any_walls() && (first || walls_.move()))
    write_array(group, "wall_corners", places(walls_, time), {number(walls_.points), d}, "m");
  if (any_walls() && first) {
    write_array(group, "wall_cells", cells_, {number(walls_.obstacle), d}, "1");
    write_array(group, "wall_obstacle", walls_.obstacle, {number(walls_.obstacle)}, "1");
  }
  if (any_round() && (first || round_.move()))
    write_array(group, "round_places", places(round_, time), {number(round_.points), d}, "m");
  if (any_round() && first) {
    write_array(group, "round_radius", radii_, {number(radii_)}, "m");
    write_array(group, "round_obstacle", round_.obstacle, {number(radii_)}, "1");
  }
}

std::string ShownObstacles::walls_grid(double time, const std::string& first,
                                       const std::string& own) const {
  const int d = box_.dimension;
  const std::size_t cells = walls_.obstacle.size();
  return fmt::format(
      "<Grid Name=\"walls\"><Time Value=\"{:.9g}\"/>\n  <Topology TopologyType=\"{}\" "
      "NumberOfElements=\"{}\">{}</Topology>\n  <Geometry GeometryType=\"{}\">{}</Geometry>\n"
      "  <Attribute Name=\"obstacle\" Center=\"Cell\">{}</Attribute>\n</Grid>\n",
      time, d == 2 ? "Polyline\" NodesPerElement=\"2" : "Triangle", cells,
      item(first + "/wall_cells", fmt::format("{} {}", cells, d), kWhole), d == 2 ? "XY" : "XYZ",
      item((walls_.move() ? own : first) + "/wall_corners",
           fmt::format("{} {}", walls_.points.size(), d), kReal),
      item(first + "/wall_obstacle", fmt::format("{}", cells), kReal));
}

std::string ShownObstacles::round_grid(double time, const std::string& first,
                                       const std::string& own) const {
  const std::string n = fmt::format("{}", radii_.size());
  std::string out = fmt::format(
      "<Grid Name=\"round_obstacles\"><Time Value=\"{:.9g}\"/>\n  <Topology "
      "TopologyType=\"Polyvertex\" NumberOfElements=\"{}\"/>\n  <Geometry "
      "GeometryType=\"{}\">{}</Geometry>\n",
      time, n, box_.dimension == 2 ? "XY" : "XYZ",
      item((round_.move() ? own : first) + "/round_places", fmt::format("{} {}", n, box_.dimension),
           kReal));
  for (const char* name : {"radius", "obstacle"})
    out += fmt::format("  <Attribute Name=\"{}\" Center=\"Node\">{}</Attribute>\n", name,
                       item(fmt::format("{}/round_{}", first, name), n, kReal));
  return out + "</Grid>\n";
}

}  // namespace lbm
