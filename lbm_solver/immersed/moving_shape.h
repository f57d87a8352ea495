// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "lbm_solver/base/held_bytes.h"
#include "lbm_solver/base/pose.h"
#include "lbm_solver/immersed/geometry.h"

namespace lbm {

/// Cells of a row that a moving solid covers, side by side.
struct CoverSpan {
  int x, y, z;                    ///< of the first one, among the rank's cells
  Vec3 arm;                       ///< from the covering image's centre() to that cell's centre
  std::span<const double> cover;  ///< solid fraction, or kCore
  std::span<const double> far;    ///< likewise, of a drum what faces out and is no part of its load
  std::span<const double> still;  ///< likewise, or kWall, of a steady one what stands
};

/// A mesh that moves as a rigid body, and which cells it covers where it is. As bodies it is mapped
/// on a grid of places and angles, kSnap apart at its farthest corner: one that creeps keeps its
/// map for many steps, and a map depends on the pose alone.
class MovingShape {
 public:
  /// @param shift  of curved surfaces
  /// @param drum  it is the wall of a drum, and cells farther from the pivot than this face out
  /// @param steady  it moves along itself at one velocity: what lies deepest in it is a wall at
  /// rest, through which nothing passes; of a drum all that faces out stands
  MovingShape(MeshSolid at_rest, const RadiusShift& shift, std::optional<double> drum = {},
              bool steady = false);

  /// @return whether the map of this pose is another one than that of the last
  bool look(const Pose& pose);
  /// The pivot of that pose on the grid of kSnap, so that arms are exact.
  Vec3 centre() const;
  /// The cells of the pose that was looked at; images across periodic sides too. Core is what has
  /// nothing but whole cells within two cells around it; a steady one's wall at rest is what has
  /// nothing but core within two cells, its other images and the walls of the box included.
  /// @throws std::invalid_argument  see fill()
  void map(const Domain& domain, const Block& cells,
           const std::function<void(const CoverSpan&)>& take) const;
  /// Of memory that it holds beside itself; the mesh at rest is the scene's.
  std::size_t bytes() const { return held(mesh_.vertices) + held(mesh_.triangles) + held(bend_); }

 private:
  struct Image;
  std::vector<Image> images(const Domain& domain, const Block& cells) const;
  void add_image(const Vec3& offset, const Domain& domain, const Block& cells,
                 std::vector<Image>& found) const;
  void take_rows(const Image& image, const Domain& domain, const Block& cells,
                 const std::function<void(const CoverSpan&)>& take) const;

  MeshSolid at_rest_;
  RadiusShift shift_;
  std::optional<double> drum_;
  bool steady_;
  std::vector<double> bend_;  // of each vertex
  Pose pose_;
  bool looked_ = false;
  TriangleMesh mesh_;   // in the pose
  double reach_ = 1.0;  // of the farthest corner from the axis
};

}  // namespace lbm
