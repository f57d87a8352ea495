// SPDX-License-Identifier: GPL-2.0-or-later
#include "lbm_solver/solver/shape_check.h"

#include <fmt/core.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "lbm_solver/base/errors.h"
#include "lbm_solver/immersed/geometry.h"

namespace lbm {
namespace {

constexpr double kCovered = 1.0 - 1e-6;  // of a cell that lets nothing through
constexpr double kLarge = 4.0;           // sizes of the box, of a mesh
constexpr double kSmall = 4.0;           // cells, of a mesh

/// A mesh in a unit so small that no cell sees it is refused; one that is large or small, and would
/// lie well in the box by the unit of another file, is named.
void check_mesh_size(const Scene& s, Plan& plan) {
  for (std::size_t i = 0; i < s.obstacles.size(); ++i) {
    const ObstacleScene& o = s.obstacles[i];
    if (!o.mesh) continue;
    const auto [low, high] = bounds(*o.mesh->surface);
    const double size = (high - low).maxCoeff(), most = s.box.size.maxCoeff();
    const std::string& other = o.mesh->other_scale;
    if (size >= plan.units.dx * (1.0 - 1e-9)) {
      if (!other.empty() && (size > kLarge * most || size < kSmall * plan.units.dx))
        plan.warnings.push_back(
            fmt::format("the mesh of the {}. obstacle is {:.3g} m large, the box {:.3g} m: {}",
                        i + 1, size, most, other));
      continue;
    }
    const bool from_file = !o.mesh->file.starts_with("of a ");
    throw InputError(
        fmt::format("{}: the {}. obstacle's mesh", s.file, i + 1),
        fmt::format("is {:.3g} m large, {:.2g} of a cell: no cell sees it", size,
                    size / plan.units.dx),
        !other.empty() ? other
        : from_file
            ? "are its lengths in metres already? then leave scale out (0.001 is for a file in mm)"
            : "take finer cells, or a larger obstacle");
  }
}

/// Whether the scene says where an image begins.
bool is_placed(const Scene& s, std::size_t obstacle) {
  return s.settings.contains(fmt::format("obstacle.{}.at", obstacle + 1));
}

/// What to say of an array that is thin along x, as [y][x][colour] is; empty of others.
std::string colours_text(const ImageScene& image) {
  const Cell3& n = image.voxels->size;
  const std::string kind = std::filesystem::path(image.file).extension().string();
  const bool array = kind == ".npy" || kind == ".h5" || kind == ".hdf5";
  if (!array || (n[0] != 3 && n[0] != 4) || std::min(n[1], n[2]) <= 2 * n[0]) return {};
  return fmt::format(
      "; its array has the shape ({}, {}, {}), is that [y][x][colour]? wanted is [z][y][x]", n[2],
      n[1], n[0]);
}

/// An image that begins at the box's corner since nothing is said, and ends before the box does.
void check_gaps(const Scene& s, Plan& plan) {
  for (std::size_t i = 0; i < s.obstacles.size(); ++i) {
    const auto& image = s.obstacles[i].image;
    if (!image || is_placed(s, i)) continue;
    std::string gaps;
    for (int k = 0; k < s.box.dimension; ++k) {
      const double fills = image->voxels->size[k] * image->voxel;
      if (fills < s.box.size[k] - 0.5 * plan.units.dx)
        gaps += fmt::format("{}{:.4g} of {:.4g} m along {}", gaps.empty() ? "" : ", ", fills,
                            s.box.size[k], "xyz"[k]);
    }
    if (!gaps.empty())
      plan.warnings.push_back(
          fmt::format("the image of the {}. obstacle fills {} only, and fluid lies beside it: is "
                      "voxel = {:.4g} m right? if it is, say with at = … where the image begins{}",
                      i + 1, gaps, image->voxel, colours_text(*image)));
  }
}

/// What drives a flow along an axis, as a message says it; empty: nothing.
std::string drive_along(const Scene& s, int axis) {
  if (s.box.sides[axis] == SideKind::Periodic) {
    if (s.fluid.body_force[axis] != 0.0) return "fluid.body_force";
    if (s.box.pressure_jump[axis] != 0.0) return "box.pressure_jump";
    return s.fluid.flow && s.fluid.flow->axis == axis ? "fluid.flow_rate" : "";
  }
  const auto opens = [&](int high) {
    return std::ranges::any_of(s.boundaries, [&](const BoundaryScene& b) {
      const bool through = b.kind != BoundaryScene::Kind::Velocity || b.velocity[axis] != 0.0;
      return axis_of(b.side) == axis && is_high(b.side) == (high == 1) && through;
    });
  };
  return opens(0) && opens(1) ? "the boundary conditions" : "";
}

/// Cells of the box that obstacles at rest cover whole.
class Covered {
 public:
  Covered(const Scene& s, const Plan& plan)
      : domain_(plan.domain), lattice_(lattice(plan.kernel.lattice)), n_(plan.domain.cells()) {
    std::vector<float> fraction(static_cast<std::size_t>(n_[0]) * n_[1] * n_[2], 0.0F);
    const auto add = [&](const Geometry& shape) {
      fill(shape, domain_, Block::whole(domain_), {}, [&](const FractionSpan& span) {
        float* row = &fraction[number({span.x, span.y, span.z})];
        for (std::size_t x = 0; x < span.fractions.size(); ++x)
          row[x] += static_cast<float>(span.fractions[x]);
      });
    };
    const std::vector<Geometry> shapes = obstacle_shapes(s, plan);
    std::size_t next = 0;
    for (const ObstacleScene& o : s.obstacles) {
      if (o.body() || o.block()) continue;
      if (const Geometry& shape = shapes[next++]; !o.motion) add(shape);
    }
    for (const CellBox& block : obstacle_blocks(s, plan)) add({block});
    for (const float f : fraction) whole_.push_back(f >= kCovered);
  }

  /// Whether fluid cells join both ends of an axis.
  /// @param sides_only  from cell to cell across their sides; else as populations go, which pass
  ///                    between two covered cells that touch along an edge or at a corner
  bool leaves_a_way(int axis, bool sides_only) const {
    std::vector<bool> seen = whole_;
    std::vector<Cell3> next;
    const auto visit = [&](const Cell3& c) {
      if (seen[number(c)]) return;
      seen[number(c)] = true;
      next.push_back(c);
    };
    Cell3 end = n_;
    end[axis] = 1;
    for (int z = 0; z < end[2]; ++z)
      for (int y = 0; y < end[1]; ++y)
        for (int x = 0; x < end[0]; ++x) visit({x, y, z});
    while (!next.empty()) {
      const Cell3 cell = next.back();
      next.pop_back();
      if (cell[axis] == n_[axis] - 1) return true;
      each_neighbour(cell, axis, sides_only, visit);
    }
    return false;
  }

 private:
  std::size_t number(const Cell3& c) const {
    return (static_cast<std::size_t>(c[2]) * n_[1] + c[1]) * n_[0] + c[0];
  }
  /// Through periodic sides, but not those of `axis`.
  template <class F>
  void each_neighbour(const Cell3& cell, int axis, bool sides_only, F&& f) const {
    for (int q = 1; q < lattice_.Q; ++q) {
      const int* c = lattice_.c[q];
      if (sides_only && std::abs(c[0]) + std::abs(c[1]) + std::abs(c[2]) > 1) continue;
      Cell3 to{cell[0] + c[0], cell[1] + c[1], cell[2] + c[2]};
      bool outside = false;
      for (int k = 0; k < 3; ++k) {
        if (to[k] >= 0 && to[k] < n_[k]) continue;
        outside = outside || k == axis || domain_.sides()[k] != Side::Periodic;
        to[k] = (to[k] + n_[k]) % n_[k];
      }
      if (!outside) f(to);
    }
  }

  Domain domain_;
  const Lattice& lattice_;
  Cell3 n_;
  std::vector<bool> whole_;
};

/// A flow that is driven against a wall. Looked for where an image is: what it holds is not seen
/// in the scene.
void check_way(const Scene& s, Plan& plan) {
  if (std::ranges::none_of(s.obstacles, [](const auto& o) { return o.image.has_value(); })) return;
  std::optional<Covered> covered;
  for (int k = 0; k < s.box.dimension; ++k) {
    const std::string drive = drive_along(s, k);
    if (drive.empty()) continue;
    if (!covered) covered.emplace(s, plan);
    const bool open = covered->leaves_a_way(k, true);
    if (!open && covered->leaves_a_way(k, false))
      plan.warnings.push_back(fmt::format(
          "along {}, where {} drives a flow, the only way leads between covered cells that touch "
          "at an edge or a corner: what seeps through there hangs on the cells alone; of an image "
          "look at threshold and solid, or take finer voxels",
          "xyz"[k], drive));
    else if (!open)
      plan.warnings.push_back(fmt::format(
          "obstacles close the box along {}, and {} drives a flow there: nothing gets through; of "
          "an image look at threshold and solid, or take finer voxels",
          "xyz"[k], drive));
  }
}

}  // namespace

void check_shapes(const Scene& s, Plan& plan) {
  check_mesh_size(s, plan);
  check_gaps(s, plan);
  check_way(s, plan);
}

}  // namespace lbm
