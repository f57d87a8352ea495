// SPDX-License-Identifier: MIT
#include "protocol/wire/overlap.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <utility>
#include <vector>

#include "protocol/wire/text.h"

namespace protocol {
namespace {

constexpr int kNone = -1;
using Cell = std::array<std::int64_t, 3>;

/// Lists of balls by cell: an open table of cells, each with a chain of balls.
class CellLists {
 public:
  explicit CellLists(std::size_t balls) : next_(balls, kNone) { resize(64); }

  void insert(std::uint64_t key, int ball) {
    if (2 * (used_ + 1) > keys_.size()) resize(2 * keys_.size());
    const std::size_t at = slot(key);
    if (heads_[at] == kNone) ++used_;
    keys_[at] = key;
    next_[ball] = heads_[at];
    heads_[at] = ball;
  }
  int first(std::uint64_t key) const { return heads_[slot(key)]; }
  int next(int ball) const { return next_[ball]; }

 private:
  std::size_t slot(std::uint64_t key) const {
    std::uint64_t mixed = key * 0x9E3779B97F4A7C15ULL;
    std::size_t at = (mixed ^ (mixed >> 32)) & (keys_.size() - 1);
    while (heads_[at] != kNone && keys_[at] != key) at = (at + 1) & (keys_.size() - 1);
    return at;
  }
  void resize(std::size_t size) {
    const std::vector<std::uint64_t> keys = std::exchange(keys_, std::vector<std::uint64_t>(size));
    const std::vector<int> heads = std::exchange(heads_, std::vector<int>(size, kNone));
    for (std::size_t i = 0; i < keys.size(); ++i) {
      if (heads[i] == kNone) continue;
      const std::size_t at = slot(keys[i]);
      keys_[at] = keys[i];
      heads_[at] = heads[i];
    }
  }
  std::vector<std::uint64_t> keys_;
  std::vector<int> heads_, next_;
  std::size_t used_ = 0;
};

/// Cells at least as wide as `reach` radii of their level, which are halved from one to the next.
class Grid {
 public:
  Grid(const Hello& box, double largest, double reach)
      : box_(box), largest_(largest), reach_(reach) {}

  int level(double radius) const {
    return std::clamp(static_cast<int>(std::log2(largest_ / radius)), 0, kLevels - 1);
  }

  /// Calls `look` with the key of the cell at `x` and of those around it, each once.
  template <class Look>
  void around(int level, const Vec3& x, Look&& look) const {
    std::array<std::array<std::int64_t, 3>, 3> near{};
    std::array<int, 3> count{1, 1, 1};
    for (unsigned k = 0; k < box_.dimension; ++k) {
      const std::int64_t cells = cells_along(level, k), at = index(level, k, x[k]);
      count[k] = 0;
      for (std::int64_t i = at - 1; i <= at + 1; ++i) {
        if (!box_.periodic[k] && (i < 0 || i >= cells)) continue;
        const std::int64_t cell = (i + cells) % cells;
        const auto end = near[k].begin() + count[k];
        if (std::find(near[k].begin(), end, cell) == end) near[k][count[k]++] = cell;
      }
    }
    for (int a = 0; a < count[0]; ++a)
      for (int b = 0; b < count[1]; ++b)
        for (int c = 0; c < count[2]; ++c) look(key(level, {near[0][a], near[1][b], near[2][c]}));
  }

  std::uint64_t key_at(int level, const Vec3& x) const {
    Cell cell{};
    for (unsigned k = 0; k < box_.dimension; ++k) cell[k] = index(level, k, x[k]);
    return key(level, cell);
  }

  double distance(const Vec3& a, const Vec3& b) const {
    double squares = 0.0;
    for (unsigned k = 0; k < box_.dimension; ++k) {
      const double length = box_.box_hi[k] - box_.box_lo[k];
      double d = a[k] - b[k];
      if (box_.periodic[k]) d -= length * std::round(d / length);
      squares += d * d;
    }
    return std::sqrt(squares);
  }

 private:
  static constexpr int kLevels = 16;
  static constexpr std::int64_t kMostCells = 1 << 20;

  std::int64_t cells_along(int level, unsigned k) const {
    const double cells = (box_.box_hi[k] - box_.box_lo[k]) / std::ldexp(reach_ * largest_, -level);
    return std::clamp(static_cast<std::int64_t>(std::min(cells, 1e9)), std::int64_t{1}, kMostCells);
  }
  std::int64_t index(int level, unsigned k, double x) const {
    const std::int64_t cells = cells_along(level, k);
    double part = (x - box_.box_lo[k]) / (box_.box_hi[k] - box_.box_lo[k]);
    if (box_.periodic[k]) part -= std::floor(part);
    const double at = std::floor(part * static_cast<double>(cells));
    return static_cast<std::int64_t>(std::clamp(at, 0.0, static_cast<double>(cells - 1)));
  }
  static std::uint64_t key(int level, const Cell& cell) {
    std::uint64_t key = static_cast<std::uint64_t>(level);
    for (const std::int64_t i : cell) key = key << 20 | static_cast<std::uint64_t>(i);
    return key;
  }
  const Hello& box_;
  double largest_, reach_;
};

}  // namespace

/// The larger first: a ball then looks for the centres of larger ones, in their cells, of which
/// each holds a few only. What was there before looks among the new ones alone.
std::optional<Overlap> find_overlap(std::span<const Ball> balls, const Hello& box, Depth depth) {
  if (balls.empty()) return std::nullopt;
  std::vector<int> order(balls.size());
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(),
                   [&](int a, int b) { return balls[a].radius > balls[b].radius; });
  const bool surfaces = depth == Depth::Surface;
  const Grid grid(box, balls[order.front()].radius, surfaces ? 2.0 : 1.0);
  std::array<CellLists, 2> lists{CellLists(balls.size()), CellLists(balls.size())};  // old, new
  std::optional<Overlap> found;
  for (const int i : order) {
    const Ball& ball = balls[i];
    const int own = grid.level(ball.radius);
    for (int level = 0; level <= own && !found; ++level)
      grid.around(level, ball.x, [&](std::uint64_t key) {
        for (const bool is_new : {false, true}) {
          if (!is_new && !ball.is_new) continue;
          for (int j = lists[is_new].first(key); j != kNone && !found; j = lists[is_new].next(j)) {
            if (ball.carrier != kItself && balls[j].carrier == ball.carrier) continue;
            const double distance = grid.distance(ball.x, balls[j].x);
            const double limit =
                surfaces ? 0.99 * (balls[j].radius + ball.radius) : balls[j].radius;
            if (distance < limit) found = Overlap{balls[j], ball, distance};
          }
        }
      });
    if (found) return found;
    lists[ball.is_new].insert(grid.key_at(own, ball.x), i);
  }
  return std::nullopt;
}

std::string describe(const Overlap& pair) {
  const auto& [a, b, distance] = pair;
  return format(
      "particles {} and {} overlap: their centres ({:.6g}, {:.6g}, {:.6g}) and "
      "({:.6g}, {:.6g}, {:.6g}) m are {:.3g} m apart, their radii are {:.6g} and {:.6g} m",
      a.id, b.id, a.x[0], a.x[1], a.x[2], b.x[0], b.x[1], b.x[2], distance, a.radius, b.radius);
}

}  // namespace protocol
