// SPDX-License-Identifier: GPL-2.0-or-later
#include "lbm_solver/immersed/mesh_fractions.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

namespace lbm {
namespace {

constexpr double kRoundOff = 1e-9;  // of a fraction
constexpr double kInsideOut = 1e-6;
constexpr double kFar = 1e9;  // cells

/// A flat polygon of a few corners: a triangle cut by planes.
class Polygon {
 public:
  Polygon(const Vec3& a, const Vec3& b, const Vec3& c) : count_(3), at_{a, b, c} {}

  bool empty() const { return count_ < 3; }
  double least(int axis) const {
    return extreme(axis, [](double a, double b) { return a < b; });
  }
  double most(int axis) const {
    return extreme(axis, [](double a, double b) { return a > b; });
  }

  /// The part between two planes across an axis.
  Polygon between(int axis, double low, double high) const {
    return cut(axis, low, 1.0).cut(axis, high, -1.0);
  }

  /// Seen along x: area (with the sign of n_x), and ∫ x over it; and the true area.
  struct Measure {
    double seen = 0.0, x_moment = 0.0, area = 0.0;
  };
  Measure measure() const {
    Measure m;
    for (int k = 2; k < count_; ++k) {
      const Vec3 a = at_[k - 1] - at_[0], b = at_[k] - at_[0];
      const double nx = 0.5 * (a.y() * b.z() - a.z() * b.y());
      const double ny = 0.5 * (a.z() * b.x() - a.x() * b.z());
      const double nz = 0.5 * (a.x() * b.y() - a.y() * b.x());
      m.seen += nx;
      m.x_moment += nx * (at_[0].x() + at_[k - 1].x() + at_[k].x()) / 3.0;
      m.area += std::sqrt(nx * nx + ny * ny + nz * nz);
    }
    return m;
  }

 private:
  static constexpr int kMost = 12;  // six planes add a corner each
  Polygon() = default;

  template <class Before>
  double extreme(int axis, Before&& before) const {
    double best = at_[0][axis];
    for (int k = 1; k < count_; ++k)
      if (before(at_[k][axis], best)) best = at_[k][axis];
    return best;
  }

  /// The part where sign × (place - plane) >= 0.
  Polygon cut(int axis, double plane, double sign) const {
    Polygon part;
    for (int k = 0; k < count_; ++k) {
      const Vec3 &a = at_[k], &b = at_[(k + 1) % count_];
      const double da = sign * (a[axis] - plane), db = sign * (b[axis] - plane);
      if (da >= 0.0) part.at_[part.count_++] = a;
      if ((da > 0.0 && db < 0.0) || (da < 0.0 && db > 0.0)) {
        Vec3 middle = a + (b - a) * (da / (da - db));
        middle[axis] = plane;
        part.at_[part.count_++] = middle;
      }
    }
    return part;
  }

  int count_ = 0;
  std::array<Vec3, kMost> at_;
};

/// Sums of one layer of cells. Places are those of the box, so that what is cut does not depend on
/// where the cells begin.
class Layer {
 public:
  Layer(const Block& cells, double plane)
      : nx_(cells.size[0]),
        ny_(cells.size[1]),
        x0_(cells.begin[0]),
        y0_(cells.begin[1]),
        plane_(plane) {
    for (auto* sums : {&volume_, &added_}) sums->resize(static_cast<std::size_t>(nx_) * ny_);
    columns_.resize(static_cast<std::size_t>(nx_ + 1) * ny_);
  }
  void clear() {
    for (auto* sums : {&volume_, &columns_, &added_}) std::fill(sums->begin(), sums->end(), 0.0);
  }

  /// @param part   what lies in the layer
  /// @param thick  that is added to the solid
  void add(const Polygon& part, double thick) {
    const int first = std::max(0, static_cast<int>(std::floor(part.least(1))) - y0_);
    const int last = std::min(ny_ - 1, static_cast<int>(std::floor(part.most(1))) - y0_);
    for (int y = first; y <= last; ++y) {
      const Polygon in_row = part.between(1, y0_ + y, y0_ + y + 1.0);
      if (!in_row.empty()) add_to_row(in_row, y, thick);
    }
  }

  /// The fractions of a row. @throws std::invalid_argument
  void row(int y, bool hollow, std::vector<double>& fractions) const {
    double behind = 0.0;
    for (int x = 0; x < nx_; ++x) {
      behind += columns_[static_cast<std::size_t>(y) * (nx_ + 1) + x];
      const std::size_t at = static_cast<std::size_t>(y) * nx_ + x;
      const double inside = behind + volume_[at];
      if (inside < -kInsideOut) throw std::invalid_argument("a part of the surface faces inwards");
      const double eps = std::clamp(hollow ? 1.0 - inside : inside, 0.0, 1.0);
      const bool partly = eps > kRoundOff && eps < 1.0 - kRoundOff;
      fractions[x] = partly ? std::clamp(eps + added_[at], 0.0, 1.0) : std::round(eps);
    }
  }

 private:
  void add_to_row(const Polygon& part, int y, double thick) {
    const double low = part.least(0), high = part.most(0);
    double* columns = &columns_[static_cast<std::size_t>(y) * (nx_ + 1)];
    if (low < x0_) columns[0] -= part.between(0, -kFar, x0_).measure().seen;
    const int first = std::max(0, static_cast<int>(std::floor(low)) - x0_);
    const int last = std::min(nx_ - 1, static_cast<int>(std::floor(high)) - x0_);
    for (int x = first; x <= last; ++x) {
      const double end = x0_ + x + 1.0;
      const Polygon piece = part.between(0, x0_ + x, end);
      if (piece.empty()) continue;
      const auto [seen, x_moment, area] = piece.measure();
      const std::size_t at = static_cast<std::size_t>(y) * nx_ + x;
      volume_[at] -= end * seen - x_moment;
      columns[x + 1] -= seen;
      added_[at] += area * (plane_ + thick);
    }
  }

  int nx_, ny_, x0_, y0_;
  double plane_;
  std::vector<double> volume_, columns_, added_;
};

/// For each layer the triangles that touch it.
std::vector<std::vector<std::uint32_t>> by_layer(const TriangleMesh& mesh, int begin, int layers) {
  std::vector<std::vector<std::uint32_t>> lists(layers);
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    double low = kFar, high = -kFar;
    for (const auto v : mesh.triangles[t]) {
      low = std::min(low, mesh.vertices[v].z() - begin);
      high = std::max(high, mesh.vertices[v].z() - begin);
    }
    const int first = static_cast<int>(std::clamp(std::floor(low), 0.0, 1.0 * layers));
    const int last = static_cast<int>(std::clamp(std::floor(high), -1.0, layers - 1.0));
    for (int z = first; z <= last; ++z) lists[z].push_back(t);
  }
  return lists;
}

}  // namespace

void fill_mesh(const TriangleMesh& mesh, bool hollow, const Block& cells, const RadiusShift& shift,
               const std::function<void(const FractionSpan&)>& take) {
  fill_mesh(mesh, mean_curvatures(mesh), hollow, cells, shift, take);
}

void fill_mesh(const TriangleMesh& mesh, const std::vector<double>& curvatures, bool hollow,
               const Block& cells, const RadiusShift& shift,
               const std::function<void(const FractionSpan&)>& take) {
  std::vector<double> bend = curvatures;
  for (double& b : bend) {
    if (std::abs(b) > 1.0) b = 1.0 / b;  // smaller than RadiusShift knows
    b *= (hollow ? -1.0 : 1.0) * shift.curvature;
  }
  Layer layer(cells, shift.plane);
  std::vector<double> row(cells.size[0]);
  const auto lists = by_layer(mesh, cells.begin[2], cells.size[2]);
  for (int z = 0; z < cells.size[2]; ++z) {
    if (lists[z].empty() && !hollow) continue;
    layer.clear();
    for (const auto number : lists[z]) {
      const auto& [a, b, c] = mesh.triangles[number];
      const Polygon whole(mesh.vertices[a], mesh.vertices[b], mesh.vertices[c]);
      const int z0 = cells.begin[2] + z;
      const Polygon part = whole.between(2, z0, z0 + 1.0);
      if (!part.empty()) layer.add(part, (bend[a] + bend[b] + bend[c]) / 3.0);
    }
    for (int y = 0; y < cells.size[1]; ++y) {
      layer.row(y, hollow, row);
      const auto solid = [](double eps) { return eps > 0.0; };
      const auto first = std::find_if(row.begin(), row.end(), solid);
      if (first == row.end()) continue;
      const auto end = std::find_if(row.rbegin(), row.rend(), solid).base();
      take({static_cast<int>(first - row.begin()), y, z, {first, end}});
    }
  }
}

}  // namespace lbm
