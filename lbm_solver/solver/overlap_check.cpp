// SPDX-License-Identifier: GPL-2.0-or-later
#include "lbm_solver/solver/overlap_check.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include "lbm_solver/immersed/geometry.h"
#include "lbm_solver/solver/few.h"
#include "lbm_solver/solver/place_check.h"

namespace lbm {
namespace {

constexpr double kShared = 0.1;  // of a cell, that two solids cover more than the whole

/// The shapes of all obstacles, in cells.
std::vector<Geometry> all_shapes(const Scene& s, const Plan& plan) {
  const std::vector<Geometry> shapes = obstacle_shapes(s, plan);
  const std::vector<CellBox> blocks = obstacle_blocks(s, plan);
  const std::vector<Body> bodies = obstacle_bodies(s, plan);
  std::size_t shape = 0, block = 0, body = 0;
  std::vector<Geometry> all;
  for (const ObstacleScene& o : s.obstacles) {
    if (o.block()) {
      all.push_back({blocks[block++]});
    } else if (o.body()) {
      const Body& b = bodies[body++];
      all.push_back({Ball{b.centre, b.radius, b.hollow}});
    } else {
      all.push_back(shapes[shape++]);
    }
  }
  return all;
}

/// Lower and upper corner of what bounds an obstacle [m].
std::array<Vec3, 2> around(const ObstacleScene& o) {
  if (o.mesh) return bounds(*o.mesh->surface);
  if (o.image) {
    const Cell3& n = o.image->voxels->size;
    return {o.image->at, o.image->at + o.image->voxel * Vec3(n[0], n[1], n[2])};
  }
  if (o.block()) return {o.from, o.to};
  const Vec3 r = 0.5 * o.diameter * Vec3::Ones();
  return {o.centre - r, o.centre + r};
}

/// The cells in which two obstacles may both lie; nothing where there are none.
std::optional<Block> cells_of_both(const Scene& s, const Plan& plan, const ObstacleScene& a,
                                   const ObstacleScene& b) {
  const auto first = around(a), second = around(b);
  Block cells = Block::whole(plan.domain);
  for (int k = 0; k < s.box.dimension; ++k) {
    const double n = plan.domain.cells()[k];
    const auto in_cells = [&](double x) {
      return std::clamp((x - s.box.origin[k]) / plan.units.dx, 0.0, n);
    };
    const double low = in_cells(std::max(first[0][k], second[0][k]));
    const double high = in_cells(std::min(first[1][k], second[1][k]));
    if (high - low <= kShared) return std::nullopt;
    cells.begin[k] = static_cast<int>(std::floor(low));
    cells.size[k] = static_cast<int>(std::ceil(high)) - cells.begin[k];
  }
  return cells;
}

/// Whether two shapes cover a cell by more than the whole of it.
bool share_a_cell(const Plan& plan, const Block& cells, const Geometry& a, const Geometry& b) {
  const auto number = [&](int x, int y, int z) {
    return (static_cast<std::size_t>(z) * cells.size[1] + y) * cells.size[0] + x;
  };
  std::vector<float> sum(static_cast<std::size_t>(cells.size[0]) * cells.size[1] * cells.size[2]);
  for (const Geometry* shape : {&a, &b})
    fill(*shape, plan.domain, cells, {}, [&](const FractionSpan& span) {
      float* row = &sum[number(span.x, span.y, span.z)];
      for (std::size_t x = 0; x < span.fractions.size(); ++x)
        row[x] += static_cast<float>(span.fractions[x]);
    });
  return std::ranges::any_of(sum, [](float f) { return f > 1.0 + kShared; });
}

bool lies_in(const CellBox& inner, const CellBox& outer) {
  for (int k = 0; k < 3; ++k)
    if (inner.from[k] < outer.from[k] || inner.to[k] > outer.to[k]) return false;
  return true;
}

/// What is to be said of two obstacles; empty: nothing.
/// @param later  number of the one that stands later in the scene, from 0
std::string overlap_text(const Scene& s, const Plan& plan, const std::vector<Geometry>& shapes,
                         std::size_t later, std::size_t earlier) {
  const ObstacleScene &a = s.obstacles[later], &b = s.obstacles[earlier];
  if (a.block() && b.block()) {
    const auto& first = std::get<CellBox>(shapes[later].shape);
    const auto& second = std::get<CellBox>(shapes[earlier].shape);
    if (!lies_in(first, second) && !lies_in(second, first)) return {};  // cells are of one of them
    const bool later_is_hidden = lies_in(first, second);
    return fmt::format(
        "the {}. obstacle lies wholly in the {}., and no fluid touches it: its load stays 0; leave "
        "one of the two out",
        (later_is_hidden ? later : earlier) + 1, (later_is_hidden ? earlier : later) + 1);
  }
  const auto deep = [&](const ObstacleScene& ball, const ObstacleScene& other) {
    return depth_in(s, other, ball.centre, 0.5 * ball.diameter) > kTouch;
  };
  bool overlap = false;
  if ((a.round || a.block()) && (b.round || b.block()))
    overlap = a.round ? deep(a, b) : deep(b, a);
  else if (const auto cells = cells_of_both(s, plan, a, b))
    overlap = share_a_cell(plan, *cells, shapes[later], shapes[earlier]);
  if (!overlap) return {};
  if (a.block() || b.block())
    return fmt::format(
        "the {}. obstacle overlaps the {}., and the {}. is a block: the load on cells of "
        "both "
        "counts for both, and the sum of their loads is too large; let one end where the other "
        "begins, or draw them as one mesh",
        later + 1, earlier + 1, (a.block() ? later : earlier) + 1);
  return fmt::format(
      "the {}. obstacle overlaps the {}.: the load on cells that both cover is shared "
      "between them",
      later + 1, earlier + 1);
}

}  // namespace

void check_overlaps(const Scene& s, Plan& plan) {
  std::vector<std::size_t> solid;  // what can lie in another
  for (std::size_t i = 0; i < s.obstacles.size(); ++i)
    if (!s.obstacles[i].grain && !s.obstacles[i].hollow &&
        !(s.obstacles[i].mesh && s.obstacles[i].mesh->hollow))
      solid.push_back(i);
  if (solid.size() < 2) return;
  const std::vector<Geometry> shapes = all_shapes(s, plan);
  Few overlaps(plan, "pairs of obstacles that lie in each other");
  for (const std::size_t i : solid)
    for (const std::size_t j : solid) {
      if (j >= i) break;
      if (const std::string text = overlap_text(s, plan, shapes, i, j); !text.empty())
        overlaps.add([&] { return text; });
    }
}

}  // namespace lbm
