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
constexpr int kMargin = 2 * kCoreCells;  // from a wall at rest to that

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

  /// What it covers of a cell of the box, or beyond its periodic sides; 0 outside of the region.
  double of(const Cell3& cell) const {
    Cell3 here;
    for (int a = 0; a < 3; ++a) {
      here[a] = cell[a] - cells_.begin[a];
      if (here[a] < 0 || here[a] >= cells_.size[a]) return 0.0;
    }
    return cover_[at(here[0], here[1], here[2])];
  }
  const double* row(const Cell3& cell) const {
    return &cover_[at(cell[0] - cells_.begin[0], cell[1] - cells_.begin[1],
                      cell[2] - cells_.begin[2])];
  }

  /// Makes another kind of the cells of at least a cover that have nothing but such at the ends of
  /// some ways. @param covers  of a cell, at least what it is here
  template <class Covers>
  void mark(double kind, double least, const std::vector<Cell3>& ways, Covers&& covers) {
    const auto inside = [&](const Cell3& cell) {
      return std::ranges::all_of(ways, [&](const Cell3& way) {
        return covers(Cell3{cell[0] + way[0], cell[1] + way[1], cell[2] + way[2]}) >= least;
      });
    };
    Cell3 c;
    for (c[2] = 0; c[2] < cells_.size[2]; ++c[2])
      for (c[1] = 0; c[1] < cells_.size[1]; ++c[1])
        for (c[0] = 0; c[0] < cells_.size[0]; ++c[0]) {
          double& cover = cover_[at(c[0], c[1], c[2])];
          if (cover < least) continue;
          if (inside({c[0] + cells_.begin[0], c[1] + cells_.begin[1], c[2] + cells_.begin[2]}))
            cover = kind;
        }
  }

 private:
  std::size_t at(int x, int y, int z) const {
    return (static_cast<std::size_t>(z) * cells_.size[1] + y) * cells_.size[0] + x;
  }

  Block cells_;
  std::size_t size_;
  std::vector<double> cover_;
};

/// Ways to the cells within a distance (squared), but for the cell itself.
std::vector<Cell3> ball(int dimension, int far2) {
  std::vector<Cell3> ways;
  const int deep = dimension == 3 ? kCoreCells : 0;
  for (int z = -deep; z <= deep; ++z)
    for (int y = -kCoreCells; y <= kCoreCells; ++y)
      for (int x = -kCoreCells; x <= kCoreCells; ++x)
        if (const int way2 = x * x + y * y + z * z; way2 > 0 && way2 <= far2)
          ways.push_back({x, y, z});
  return ways;
}

bool beyond_a_wall(const Domain& domain, const Cell3& cell) {
  for (int a = 0; a < domain.dimension(); ++a)
    if (domain.sides()[a] == Side::Wall && (cell[a] < 0 || cell[a] >= domain.cells()[a]))
      return true;
  return false;
}

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

/// An image across periodic sides, and what it covers of a rank's cells and around them.
struct MovingShape::Image {
  Vec3 offset;
  Cell3 from, to;  // of the rank's cells that it may cover; empty where it covers some around only
  Region region;
};

void MovingShape::map(const Domain& domain, const Block& cells,
                      const std::function<void(const CoverSpan&)>& take) const {
  std::vector<Image> images = this->images(domain, cells);
  const auto around = ball(domain.dimension(), kCoreCells * kCoreCells);
  const auto any = [&](const Cell3& cell) {  // nothing passes beyond a wall, or between two images
    if (beyond_a_wall(domain, cell)) return kWall;
    double most = 0.0;
    for (const Image& image : images) most = std::max(most, image.region.of(cell));
    return most;
  };
  for (Image& image : images) {
    if (steady_)
      image.region.mark(kCore, 1.0, around, any);
    else
      image.region.mark(kCore, 1.0, around,
                        [&](const Cell3& cell) { return image.region.of(cell); });
  }
  // What core sends into such a wall comes back, and core forgets it: nothing builds up. Its
  // density differs beside the steps of the wall; two layers keep that from the surface.
  for (Image& image : images)
    if (steady_ && !drum_) image.region.mark(kWall, kCore, around, any);
  for (const Image& image : images) take_rows(image, domain, cells, take);
}

std::vector<MovingShape::Image> MovingShape::images(const Domain& domain,
                                                    const Block& cells) const {
  const auto [low, high] = bounds(mesh_);
  std::array<int, 2> range[3]{};
  for (int a = 0; a < domain.dimension() && !at_rest_.hollow; ++a)
    range[a] = lbm::images(low[a], high[a], cells.begin[a] - kMargin, cells.size[a] + 2 * kMargin,
                           domain.cells()[a], domain.sides()[a]);
  std::vector<Image> found;
  for (int k = range[2][0]; k <= range[2][1]; ++k)
    for (int j = range[1][0]; j <= range[1][1]; ++j)
      for (int i = range[0][0]; i <= range[0][1]; ++i)
        add_image(Vec3(i * domain.nx, j * domain.ny, k * domain.nz), domain, cells, found);
  return found;
}

void MovingShape::add_image(const Vec3& offset, const Domain& domain, const Block& cells,
                            std::vector<Image>& found) const {
  TriangleMesh mesh = mesh_;
  for (Vec3& v : mesh.vertices) v += offset;
  const auto [low, high] = bounds(mesh);
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
  }
  found.push_back({offset, from, to, Region(around)});
  found.back().region.fill(mesh, bend_, at_rest_.hollow, shift_);
}

void MovingShape::take_rows(const Image& image, const Domain& domain, const Block& cells,
                            const std::function<void(const CoverSpan&)>& take) const {
  const auto& [offset, from, to, region] = image;
  if (from[0] >= to[0]) return;
  const Vec3 centre = this->centre() + offset;
  const bool flat = domain.dimension() == 2;
  const auto n = static_cast<std::size_t>(to[0] - from[0]);
  std::vector<double> cover(n), far, still;
  for (int z = from[2]; z < to[2]; ++z)
    for (int y = from[1]; y < to[1]; ++y) {
      std::copy_n(region.row({from[0] + cells.begin[0], y + cells.begin[1], z + cells.begin[2]}), n,
                  cover.begin());
      const Vec3 first(from[0] + cells.begin[0] + 0.5, y + cells.begin[1] + 0.5,
                       flat ? centre.z() : z + cells.begin[2] + 0.5);
      far.assign(drum_ && !steady_ ? n : 0, 0.0);
      still.assign(steady_ ? n : 0, 0.0);
      for (std::size_t k = 0; k < n && (drum_ || steady_); ++k) {
        const Vec3 arm = first + Vec3(static_cast<double>(k), 0.0, 0.0) - centre;
        const bool outside = drum_ && arm.norm() >= *drum_;
        if (steady_ && outside) still[k] = cover[k] >= 1.0 ? kWall : cover[k];
        if (steady_ && cover[k] == kWall) still[k] = kWall;
        if (!steady_ && outside) far[k] = cover[k];
        if (outside || (steady_ && still[k] > 0.0)) cover[k] = 0.0;
      }
      take({from[0], y, z, first - centre, cover, far, still});
    }
}

}  // namespace lbm
