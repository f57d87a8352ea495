// SPDX-License-Identifier: GPL-2.0-or-later
#include "lbm_solver/immersed/moving_shape.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <utility>

#include "lbm_solver/immersed/cover_block.h"
#include "lbm_solver/immersed/footprint.h"
#include "lbm_solver/immersed/mesh_fractions.h"

namespace lbm {
namespace {

constexpr int kCoreCells = 2;  // from one of the core to the next that is not covered whole
constexpr int kMargin = kCoreCells + 1;  // from a wall at rest to that

/// What a mesh covers of a block of cells that may reach beyond the rank's.
class Region {
 public:
  explicit Region(const Block& cells) : cells_(cells) {
    size_ = static_cast<std::size_t>(cells.size[0]) * cells.size[1] * cells.size[2];
    cover_.resize(size_);
  }

  void fill(const TriangleMesh& mesh, const std::vector<double>& bend, bool hollow,
            const RadiusShift& shift) {
    fill_mesh(mesh, bend, hollow, cells_, shift, [this](const FractionSpan& span) {
      std::ranges::copy(span.fractions, &cover_[at(span.x, span.y, span.z)]);
    });
    for (double& c : cover_)
      if (c >= kWhole) c = 1.0;
  }

  /// Makes core of the whole cells that have nothing but whole cells around them.
  void mark_core(int dimension) {
    each_inside(ball(dimension, kCoreCells * kCoreCells), 1.0,
                [this](std::size_t k) { cover_[k] = kCore; });
  }
  /// Makes walls at rest of the core that has nothing but core beside it, across corners too. What
  /// core sends into one comes back, and core forgets it: nothing builds up, and no mass passes.
  void mark_wall(int dimension) {
    each_inside(ball(dimension, dimension), kCore, [this](std::size_t k) { cover_[k] = kWall; });
  }
  const double* row(int x, int y, int z) const { return &cover_[at(x, y, z)]; }

 private:
  std::size_t at(int x, int y, int z) const {
    return (static_cast<std::size_t>(z) * cells_.size[1] + y) * cells_.size[0] + x;
  }
  /// Ways to the cells within a distance of one (squared), but for itself.
  static std::vector<Cell3> ball(int dimension, int far2) {
    std::vector<Cell3> ways;
    const int deep = dimension == 3 ? kCoreCells : 0;
    for (int z = -deep; z <= deep; ++z)
      for (int y = -kCoreCells; y <= kCoreCells; ++y)
        for (int x = -kCoreCells; x <= kCoreCells; ++x)
          if (const int way2 = x * x + y * y + z * z; way2 > 0 && way2 <= far2)
            ways.push_back({x, y, z});
    return ways;
  }
  /// Calls f for the cells of at least a cover that have nothing but such at the ends of some ways.
  template <class F>
  void each_inside(const std::vector<Cell3>& ways, double least, F&& f) {
    std::vector<std::uint8_t> whole(size_);
    for (std::size_t k = 0; k < size_; ++k) whole[k] = cover_[k] >= least;
    Cell3 c;
    for (c[2] = 0; c[2] < cells_.size[2]; ++c[2])
      for (c[1] = 0; c[1] < cells_.size[1]; ++c[1])
        for (c[0] = 0; c[0] < cells_.size[0]; ++c[0])
          if (whole[at(c[0], c[1], c[2])] && inside(whole, c, ways)) f(at(c[0], c[1], c[2]));
  }
  bool inside(const std::vector<std::uint8_t>& whole, const Cell3& c,
              const std::vector<Cell3>& ways) const {
    return std::ranges::all_of(ways, [&](const Cell3& way) {
      Cell3 there;
      for (int a = 0; a < 3; ++a) {
        there[a] = c[a] + way[a];
        if (there[a] < 0 || there[a] >= cells_.size[a]) return false;
      }
      return whole[at(there[0], there[1], there[2])] != 0;
    });
  }

  Block cells_;
  std::size_t size_;
  std::vector<double> cover_;
};

/// Images [first, last] across a pair of periodic sides of what lies between low and high that may
/// touch the cells from begin on.
std::array<int, 2> images(double low, double high, int begin, int size, int n, Side side) {
  if (side == Side::Wall) return {0, 0};
  return {static_cast<int>(std::ceil((begin - high) / n)),
          static_cast<int>(std::floor((begin + size - low) / n))};
}

}  // namespace

MovingShape::MovingShape(MeshSolid at_rest, const RadiusShift& shift, std::optional<double> drum,
                         bool steady)
    : at_rest_(std::move(at_rest)),
      shift_(shift),
      drum_(drum),
      steady_(steady),
      bend_(mean_curvatures(*at_rest_.mesh)),
      mesh_(*at_rest_.mesh) {}

bool MovingShape::look(const Pose& pose) {
  if (!looked_)
    for (const Vec3& v : at_rest_.mesh->vertices)
      reach_ = std::max(reach_, pose.axis.cross(Vec3(v - pose.pivot)).norm());
  Pose snapped = pose;
  snapped.shift = (pose.shift / kSnap).array().round().matrix() * kSnap;
  snapped.angle = std::round(pose.angle * reach_ / kSnap) * kSnap / reach_;
  const bool same = looked_ && snapped.shift == pose_.shift && snapped.angle == pose_.angle &&
                    snapped.axis == pose_.axis;
  pose_ = snapped;
  looked_ = true;
  if (same) return false;
  for (std::size_t k = 0; k < mesh_.vertices.size(); ++k)
    mesh_.vertices[k] = pose_.moved(at_rest_.mesh->vertices[k]);
  return true;
}

Vec3 MovingShape::centre() const {
  return (pose_.centre() / kSnap).array().round().matrix() * kSnap;
}

void MovingShape::map(const Domain& domain, const Block& cells,
                      const std::function<void(const CoverSpan&)>& take) const {
  if (at_rest_.hollow) return map_image(Vec3(), domain, cells, take);
  const auto [low, high] = bounds(mesh_);
  const Side sides[] = {domain.x, domain.y, domain.z};
  std::array<int, 2> range[3]{};
  for (int a = 0; a < domain.dimension(); ++a)
    range[a] = images(low[a], high[a], cells.begin[a], cells.size[a], domain.cells()[a], sides[a]);
  for (int k = range[2][0]; k <= range[2][1]; ++k)
    for (int j = range[1][0]; j <= range[1][1]; ++j)
      for (int i = range[0][0]; i <= range[0][1]; ++i)
        map_image(Vec3(i * domain.nx, j * domain.ny, k * domain.nz), domain, cells, take);
}

void MovingShape::map_image(const Vec3& offset, const Domain& domain, const Block& cells,
                            const std::function<void(const CoverSpan&)>& take) const {
  TriangleMesh image = mesh_;
  for (Vec3& v : image.vertices) v += offset;
  const auto [low, high] = bounds(image);
  Block around = cells;  // what the core is found from
  Cell3 from{0, 0, 0}, to = cells.size;
  for (int a = 0; a < domain.dimension(); ++a) {
    int begin = cells.begin[a] - kMargin, end = cells.begin[a] + cells.size[a] + kMargin;
    if (!at_rest_.hollow) {
      begin = std::max(begin, static_cast<int>(std::floor(low[a])) - kMargin);
      end = std::min(end, static_cast<int>(std::ceil(high[a])) + kMargin);
    }
    if (begin >= end) return;
    around.begin[a] = begin;
    around.size[a] = end - begin;
    from[a] = std::max(0, begin - cells.begin[a]);
    to[a] = std::min(cells.size[a], end - cells.begin[a]);
    if (from[a] >= to[a]) return;
  }
  Region region(around);
  region.fill(image, bend_, at_rest_.hollow, shift_);
  region.mark_core(domain.dimension());
  if (steady_) region.mark_wall(domain.dimension());
  const Vec3 centre = this->centre() + offset;
  const bool flat = domain.dimension() == 2;
  std::vector<double> inner;
  for (int z = from[2]; z < to[2]; ++z)
    for (int y = from[1]; y < to[1]; ++y) {
      const auto in_region = [&](int c, int a) { return c + cells.begin[a] - around.begin[a]; };
      const double* row = region.row(in_region(from[0], 0), in_region(y, 1), in_region(z, 2));
      const Vec3 first(from[0] + cells.begin[0] + 0.5, y + cells.begin[1] + 0.5,
                       flat ? centre.z() : z + cells.begin[2] + 0.5);
      const std::span<const double> cover(row, static_cast<std::size_t>(to[0] - from[0]));
      inner.assign(drum_ ? cover.size() : 0, 0.0);
      for (std::size_t k = 0; k < inner.size(); ++k) {
        const Vec3 arm(first.x() - centre.x() + static_cast<double>(k), first.y() - centre.y(),
                       first.z() - centre.z());
        if (arm.norm() < *drum_) inner[k] = cover[k];
      }
      take({from[0], y, z, first - centre, cover, inner});
    }
}

}  // namespace lbm
