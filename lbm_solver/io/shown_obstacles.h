// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "lbm_solver/base/motion.h"
#include "lbm_solver/base/scene.h"

namespace lbm {

/// The obstacles of a scene as frames show them beside the fluid, where they are at each time:
/// surfaces of triangles (`walls`; in two dimensions outlines of lines), and round ones by centre
/// and radius (`round_obstacles`). A disc that turns has a line that turns with it. Images are
/// shown by their cells. What stays where it is comes with the first frame alone, and a scene
/// without obstacles writes nothing. (A group is an id of HDF5, a hid_t.)
class ShownObstacles {
 public:
  ShownObstacles() = default;  ///< none
  explicit ShownObstacles(const Scene& scene);

  bool any_walls() const { return !walls_.parts.empty(); }
  bool any_round() const { return !round_.parts.empty(); }
  /// Whether the first frame of a file has what later ones refer to.
  bool lie_in(std::int64_t first_frame) const;

  /// Into the group of a frame. @param first  it is the first one of its file
  void write(std::int64_t group, double time, bool first) const;
  /// Grids of a frame for ParaView. @param first, own  names of the first frame and of this one
  std::string walls_grid(double time, const std::string& first, const std::string& own) const;
  std::string round_grid(double time, const std::string& first, const std::string& own) const;

 private:
  /// Points that move together.
  struct Part {
    std::size_t begin, end;
    Vec3 middle;  ///< which stays in the box where sides are periodic
    std::optional<MotionScene> motion;
  };
  struct Shapes {
    std::vector<Vec3> points;  ///< at rest [m]
    std::vector<Part> parts;
    std::vector<double> obstacle;  ///< of each cell, or point: its number in the scene

    void add(const std::vector<Vec3>& points, const std::optional<MotionScene>& motion);
    bool move() const;
  };

  void add_surface(const TriangleMesh& mesh, const std::optional<MotionScene>& motion,
                   double number);
  void add_mark(const ObstacleScene& obstacle, double number);
  void add_cell(std::initializer_list<std::size_t> corners, double number);
  std::vector<double> places(const Shapes& shapes, double time) const;

  BoxScene box_;
  Shapes walls_, round_;
  std::vector<int> cells_;  ///< corners of triangles or lines
  std::vector<double> radii_;
};

}  // namespace lbm
