// SPDX-License-Identifier: GPL-2.0-or-later
#include "lbm_solver/base/mesh_cut.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <numbers>
#include <set>
#include <unordered_map>
#include <utility>
#include <vector>

namespace lbm {
namespace {

using Polygon = std::vector<Vec3>;
constexpr double kFlat = 1e-10;      // of the cosine between two triangles of one plane
constexpr double kSharp = 0.009;     // rad: LIGGGHTS warns below 0.5 degrees, and stops at 0.0045
constexpr double kLongest = 60.0;    // length over width of a piece
constexpr double kMostPieces = 1e3;  // of a quadrangle
constexpr double kOnSide = 1e-9;     // of the box's size: a corner lies on its side
constexpr double kShort = 1e-6;      // of the box's size: an edge that is no edge
constexpr int kRounds = 20;          // of looking for needles

/// Smallest angle of a triangle [rad], 0 where it has no area.
double smallest_angle(const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 m = b - a, n = c - a;
  const double area = std::hypot(m.y() * n.z() - m.z() * n.y(), m.z() * n.x() - m.x() * n.z(),
                                 m.x() * n.y() - m.y() * n.x());
  return std::min({std::atan2(area, (b - a).dot(c - a)), std::atan2(area, (a - b).dot(c - b)),
                   std::atan2(area, (a - c).dot(b - c))});
}

double smallest_angle(const TriangleMesh& mesh, const TriangleMesh::Triangle& t) {
  return smallest_angle(mesh.vertices[t[0]], mesh.vertices[t[1]], mesh.vertices[t[2]]);
}

double length_of(const TriangleMesh& mesh, const TriangleMesh::Triangle& t, int side) {
  return (mesh.vertices[t[(side + 1) % 3]] - mesh.vertices[t[side]]).norm();
}

/// The side of a triangle that is longest, or shortest, by its first corner.
int side_of(const TriangleMesh& mesh, const TriangleMesh::Triangle& t, bool longest) {
  int found = 0;
  double length = 0.0;
  for (int k = 0; k < 3; ++k) {
    const double now = length_of(mesh, t, k);
    if (k > 0 && (now > length) != longest) continue;
    found = k;
    length = now;
  }
  return found;
}

/// Where an edge crosses a plane; the same to the bit from both of the triangles that share it.
Vec3 crossing(Vec3 a, Vec3 b, int axis, double place) {
  if (a[axis] > b[axis]) std::swap(a, b);
  Vec3 x = a + (place - a[axis]) / (b[axis] - a[axis]) * (b - a);
  x[axis] = place;
  return x;
}

/// What is left of a convex polygon on one side of a plane.
/// @param sign  1: below the place, -1: above
Polygon half(const Polygon& polygon, int axis, double place, double sign, double near) {
  Polygon rest;
  const auto beyond = [&](const Vec3& x) { return sign * (x[axis] - place) > near; };
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Vec3 &a = polygon[i], &b = polygon[(i + 1) % polygon.size()];
    if (!beyond(a)) rest.push_back(a);
    // an edge that ends on the plane has no other end there
    const auto inside = [&](const Vec3& x) { return sign * (x[axis] - place) < -near; };
    if ((beyond(a) && inside(b)) || (inside(a) && beyond(b)))
      rest.push_back(crossing(a, b, axis, place));
  }
  return rest;
}

/// A box, and what counts as on its sides.
struct Room {
  Vec3 low, high;
  double near;
  bool holds(const Vec3& x) const {
    return (low - x).maxCoeff() <= near && (x - high).maxCoeff() <= near;
  }
  Polygon cut(Polygon polygon) const {
    for (int k = 0; k < 3; ++k) {
      polygon = half(polygon, k, low[k], -1.0, near);
      polygon = half(polygon, k, high[k], 1.0, near);
    }
    return polygon;
  }
  /// Whether a polygon lies wholly beyond one of the sides.
  bool misses(const Polygon& p) const {
    for (int k = 0; k < 3; ++k)
      if (std::ranges::all_of(p, [&](const Vec3& x) { return x[k] < low[k] - near; }) ||
          std::ranges::all_of(p, [&](const Vec3& x) { return x[k] > high[k] + near; }))
        return true;
    return false;
  }
  /// An edge without what lies farther along it from the middle than the box is large.
  std::array<Vec3, 2> near_part(const Vec3& a, const Vec3& b) const {
    const Vec3 way = b - a;
    const double length = way.norm();
    const double middle = way.dot(0.5 * (low + high) - a) / length, size = (high - low).norm();
    const auto at = [&](double place) {
      return place <= 0.0 ? a : place >= length ? b : Vec3(a + place / length * way);
    };
    return {at(middle - size), at(middle + size)};
  }
  /// On a side, where it lies there but for round-off.
  Vec3 settled(Vec3 x) const {
    for (int k = 0; k < 3; ++k)
      for (const double side : {low[k], high[k]})
        if (std::abs(x[k] - side) <= near) x[k] = side;
    return x;
  }
  int sides_at(const Vec3& x) const {
    int count = 0;
    for (int k = 0; k < 3; ++k) count += (x[k] <= low[k] ? 1 : 0) + (x[k] >= high[k] ? 1 : 0);
    return count;
  }
};

/// Two triangles of one plane that share their longest sides are a quadrangle.
/// @return quadrangles and the triangles that are left
std::vector<Polygon> polygons_of(const TriangleMesh& mesh) {
  const auto edge = [](std::uint64_t a, std::uint64_t b) { return a << 32 | b; };
  std::unordered_map<std::uint64_t, std::uint32_t> by_longest;  // triangles, by their longest side
  by_longest.reserve(mesh.triangles.size());
  for (std::uint32_t i = 0; i < mesh.triangles.size(); ++i) {
    const auto& t = mesh.triangles[i];
    const int k = side_of(mesh, t, true);
    by_longest.emplace(edge(t[k], t[(k + 1) % 3]), i);
  }
  std::vector<Polygon> polygons;
  for (std::uint32_t i = 0; i < mesh.triangles.size(); ++i) {
    const auto& t = mesh.triangles[i];
    const int k = side_of(mesh, t, true);
    const std::uint32_t a = t[(k + 2) % 3], b = t[k], c = t[(k + 1) % 3];
    const auto beside = by_longest.find(edge(c, b));
    if (beside != by_longest.end()) {
      const auto& other = mesh.triangles[beside->second];
      const Vec3 m = mesh.area_vector(t), n = mesh.area_vector(other);
      if (m.dot(n) >= (1.0 - kFlat) * m.norm() * n.norm()) {
        if (beside->second < i) continue;  // is there with it
        const std::uint32_t d = other[(side_of(mesh, other, true) + 2) % 3];
        polygons.push_back(
            {mesh.vertices[a], mesh.vertices[b], mesh.vertices[d], mesh.vertices[c]});
        continue;
      }
    }
    polygons.push_back({mesh.vertices[a], mesh.vertices[b], mesh.vertices[c]});
  }
  return polygons;
}

/// Of a quadrangle: where its long sides begin, and how long and wide it is.
struct Strip {
  int first = 0;
  double along = 0.0, across = 0.0;

  explicit Strip(const Polygon& p) {
    const auto side = [&](int k) { return (p[(k + 1) % 4] - p[k % 4]).norm(); };
    first = side(0) + side(2) > side(1) + side(3) ? 0 : 1;
    across = std::max(side(first + 1), side(first + 3));
    along = std::max(side(first), side(first + 2));
  }
  bool is_long() const { return along > kLongest * across && across > 0.0; }
};

/// Parts all long quadrangles along their length, into equally many pieces, so that neighbours have
/// the same corners. What lies far from the room is left out before, of an edge the same on both of
/// its sides.
std::vector<Polygon> parted(const std::vector<Polygon>& polygons, const Room& room) {
  std::vector<Polygon> all, strips;
  double longest = 0.0, narrowest = std::numeric_limits<double>::infinity();
  for (const Polygon& p : polygons) {
    if (p.size() != 4 || !Strip(p).is_long()) {
      all.push_back(p);
      continue;
    }
    const int first = Strip(p).first;
    narrowest = std::min(narrowest, Strip(p).across);
    const auto [a, b] = room.near_part(p[first], p[first + 1]);
    const auto [d, c] = room.near_part(p[(first + 3) % 4], p[first + 2]);
    longest = std::max({longest, (b - a).norm(), (c - d).norm()});
    strips.push_back({a, b, c, d});
  }
  const int pieces =
      static_cast<int>(std::clamp(std::ceil(longest / (kLongest * narrowest)), 1.0, kMostPieces));
  for (const Polygon& p : strips) {
    const auto at = [&](int from, int to, int piece) -> Vec3 {
      return piece == pieces ? p[to] : Vec3(p[from] + (1.0 * piece / pieces) * (p[to] - p[from]));
    };
    for (int k = 0; k < pieces; ++k)
      all.push_back({at(0, 1, k), at(0, 1, k + 1), at(3, 2, k + 1), at(3, 2, k)});
  }
  return all;
}

/// Gathers triangles; corners that lie together are one vertex.
class Gathered {
 public:
  explicit Gathered(const Room& room) : room_(room) {}

  /// The triangles of a convex polygon around the corner from which they are least sharp.
  void add(const Polygon& p) {
    const std::size_t n = p.size();
    if (n < 3) return;
    std::size_t from = 0;
    double best = -1.0;
    for (std::size_t first = 0; first < n; ++first) {
      double least = std::numbers::pi;
      for (std::size_t i = 1; i + 1 < n; ++i)
        least =
            std::min(least, smallest_angle(p[first], p[(first + i) % n], p[(first + i + 1) % n]));
      if (least <= best * (1.0 + kFlat)) continue;
      best = least;
      from = first;
    }
    for (std::size_t i = 1; i + 1 < n; ++i)
      mesh_.triangles.push_back(
          {vertex(p[from]), vertex(p[(from + i) % n]), vertex(p[(from + i + 1) % n])});
  }
  TriangleMesh& mesh() { return mesh_; }

 private:
  std::uint32_t vertex(const Vec3& corner) {
    const Vec3 x = room_.settled(corner);
    std::array<std::int64_t, 3> key;
    for (int k = 0; k < 3; ++k) key[k] = std::llround((x[k] - room_.low[k]) / room_.near);
    const auto [at, is_new] =
        numbers_.emplace(key, static_cast<std::uint32_t>(mesh_.vertices.size()));
    if (is_new) mesh_.vertices.push_back(x);
    return at->second;
  }
  Room room_;
  TriangleMesh mesh_;
  std::map<std::array<std::int64_t, 3>, std::uint32_t> numbers_;
};

/// Takes out triangles that are too sharp: the ends of the shortest side become one vertex where
/// that side is short, the one on more sides of the room; flat ones, whose corner lies nearly on
/// the side opposite, are dropped.
void take_needles_out(TriangleMesh& mesh, const Room& room) {
  const double least = kShort * (room.high - room.low).maxCoeff();
  for (int round = 0; round < kRounds; ++round) {
    std::vector<std::uint32_t> now(mesh.vertices.size());
    for (std::uint32_t v = 0; v < now.size(); ++v) now[v] = v;
    std::vector<bool> touched(mesh.vertices.size(), false);  // in this round
    bool changed = false;
    std::vector<TriangleMesh::Triangle> kept;
    for (const auto& t : mesh.triangles) {
      const int k = side_of(mesh, t, false), far = side_of(mesh, t, true);
      const auto length = [&](int side) { return length_of(mesh, t, side); };
      const bool sharp = smallest_angle(mesh, t) < kSharp, tiny = length(k) < least;
      if (!sharp && !tiny) {
        kept.push_back(t);
        continue;
      }
      std::uint32_t stays = t[k], goes = t[(k + 1) % 3];
      if (!tiny && length(k) > 2.0 * kSharp * length(far)) {
        changed = true;  // flat: dropped
        continue;
      }
      kept.push_back(t);
      if (touched[stays] || touched[goes]) continue;  // in the next round
      if (room.sides_at(mesh.vertices[goes]) > room.sides_at(mesh.vertices[stays]))
        std::swap(stays, goes);
      touched[stays] = touched[goes] = changed = true;
      now[goes] = stays;
    }
    if (!changed) break;
    mesh.triangles.clear();
    std::set<std::array<std::uint32_t, 3>> known;
    for (auto t : kept) {
      for (auto& v : t) v = now[v];
      auto sorted = t;
      std::ranges::sort(sorted);
      if (sorted[0] == sorted[1] || sorted[1] == sorted[2]) continue;
      if (known.insert(sorted).second) mesh.triangles.push_back(t);
    }
  }
  std::erase_if(mesh.triangles, [&](const auto& t) { return smallest_angle(mesh, t) < kSharp; });
}

/// Without the vertices that no triangle has.
TriangleMesh packed(const TriangleMesh& mesh) {
  TriangleMesh rest;
  std::map<std::uint32_t, std::uint32_t> numbers;
  for (auto t : mesh.triangles) {
    for (auto& v : t) {
      const auto [at, is_new] =
          numbers.emplace(v, static_cast<std::uint32_t>(rest.vertices.size()));
      if (is_new) rest.vertices.push_back(mesh.vertices[v]);
      v = at->second;
    }
    rest.triangles.push_back(t);
  }
  return rest;
}

}  // namespace

double sharpest_angle(const TriangleMesh& mesh) {
  double least = std::numbers::pi;
  for (const auto& t : mesh.triangles) least = std::min(least, smallest_angle(mesh, t));
  return least;
}

TriangleMesh clipped(const TriangleMesh& mesh, const Vec3& low, const Vec3& high) {
  const Room room{low, high, kOnSide * (high - low).maxCoeff()};
  const auto holds_all = [&](const std::vector<Vec3>& places) {
    return std::ranges::all_of(places, [&](const Vec3& x) { return room.holds(x); });
  };
  if (holds_all(mesh.vertices) && sharpest_angle(mesh) >= kSharp) {
    TriangleMesh same = mesh;
    for (Vec3& v : same.vertices) v = room.settled(v);
    return same;
  }
  Gathered part(room);
  for (const Polygon& p : parted(polygons_of(mesh), room))
    if (!room.misses(p)) part.add(holds_all(p) ? p : room.cut(p));
  take_needles_out(part.mesh(), room);
  return part.mesh().triangles.empty() ? mesh : packed(part.mesh());
}

TriangleMesh without_ends(const TriangleMesh& mesh, int axis, double low, double high) {
  const auto lies_at = [&](const auto& t, double place) {
    return std::ranges::all_of(t, [&](auto v) { return mesh.vertices[v][axis] == place; });
  };
  const auto at_low = [&](const auto& t) { return lies_at(t, low); };
  const auto at_high = [&](const auto& t) { return lies_at(t, high); };
  const auto ends = std::ranges::count_if(mesh.triangles, at_low);
  if (ends == 0 || ends != std::ranges::count_if(mesh.triangles, at_high)) return mesh;
  TriangleMesh rest = mesh;
  std::erase_if(rest.triangles, [&](const auto& t) { return at_low(t) || at_high(t); });
  return rest.triangles.empty() ? mesh : packed(rest);
}

TriangleMesh of_fewer_sides(const TriangleMesh& cylinder) {
  constexpr std::uint32_t every = 4;  // corner stays
  const auto before = static_cast<std::uint32_t>((cylinder.vertices.size() - 2) / 2),
             sides = before / every;
  const auto area = [](std::uint32_t corners) {  // of a polygon in a circle
    return corners * std::sin(2.0 * std::numbers::pi / corners);
  };
  const double wider = std::sqrt(area(before) / area(sides));
  TriangleMesh mesh{{cylinder.vertices[0], cylinder.vertices[1]}, {}};
  for (std::uint32_t ring = 0; ring < 2; ++ring)
    for (std::uint32_t k = 0; k < before; k += every) {
      const Vec3 &centre = mesh.vertices[ring], &v = cylinder.vertices[2 + ring * before + k];
      mesh.vertices.push_back(centre + wider * (v - centre));
    }
  for (std::uint32_t k = 0; k < sides; ++k) {
    const std::uint32_t a = 2 + k, b = 2 + (k + 1) % sides, c = a + sides, d = b + sides;
    mesh.triangles.insert(mesh.triangles.end(), {{0, b, a}, {1, c, d}, {a, b, d}, {a, d, c}});
  }
  return mesh;
}

double largest_reach(const TriangleMesh& mesh) {
  double most = 0.0;
  for (const auto& t : mesh.triangles) {
    const Vec3 middle = (mesh.vertices[t[0]] + mesh.vertices[t[1]] + mesh.vertices[t[2]]) / 3.0;
    for (const auto v : t) most = std::max(most, (mesh.vertices[v] - middle).norm());
  }
  return most;
}

TriangleMesh short_walls(const TriangleMesh& block, double reach) {
  // of a square's half with sides s the farthest corner is √5/3 s away
  const double side = 0.99 * 3.0 / std::sqrt(5.0) * reach;
  const auto [low, high] = bounds(block);
  const double z = std::min(high.z(), 0.5 * side);
  const Vec3 corners[] = {{low.x(), low.y(), 0.0},
                          {high.x(), low.y(), 0.0},
                          {high.x(), high.y(), 0.0},
                          {low.x(), high.y(), 0.0}};
  TriangleMesh walls;
  for (int k = 0; k < 4; ++k) {  // counter-clockwise: what lies to the right is outside
    const Vec3 &from = corners[k], &to = corners[(k + 1) % 4];
    const auto pieces = static_cast<std::uint32_t>(std::ceil((to - from).norm() / side));
    const auto first = static_cast<std::uint32_t>(walls.vertices.size());
    for (std::uint32_t i = 0; i <= pieces; ++i)
      for (const double end : {-z, z})
        walls.vertices.push_back(from + (1.0 * i / pieces) * (to - from) + Vec3(0.0, 0.0, end));
    for (std::uint32_t a = first; a < first + 2 * pieces; a += 2) {
      walls.triangles.push_back({a, a + 2, a + 3});
      walls.triangles.push_back({a, a + 3, a + 1});
    }
  }
  return walls;
}

}  // namespace lbm
