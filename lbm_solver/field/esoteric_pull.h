// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <array>

#include "lbm_solver/base/unroll.h"
#include "lbm_solver/field/domain.h"
#include "lbm_solver/field/populations.h"

namespace lbm {

/// In-place streaming ("Esoteric Pull", Lehmann 2022). A cell reads the populations that arrive and
/// writes those that leave at the same Q memory places, so one lattice suffices and rows may be
/// swept in any order. For a pair (i, i+1) with i+1 opposite to i:
///
///   even step   f_i   at slot i+1 of the cell itself      f_i+1 at slot i   of the cell at x + c_i
///   odd step    f_i   at slot i   of the cell itself      f_i+1 at slot i+1 of the cell at x + c_i
///
/// After collision the two change places. What a cell wrote is then where its neighbour reads.
///
/// A half-way bounce-back wall returns f_i* as f_opp(i) to the same cell: the places beyond a wall
/// in y or z keep their slot at every parity (a choice of pointer), those beyond a wall in x lie at
/// the ends of a row and are copied from the other slot before the row is swept. Places beyond a
/// face towards another rank lie in the ghost layer, which `HaloExchange` brings there and back.
///
/// This is the only file that knows the pattern.
class EsotericPull {
 public:
  explicit EsotericPull(const Faces& faces) : faces_(faces) {}
  EsotericPull(Side x, Side y, Side z = Side::Periodic)
      : faces_(Block::whole({1, 1, x, y, 1, z}).faces) {}

  const Faces& faces() const { return faces_; }
  bool odd() const { return odd_; }
  void set_odd(bool odd) { odd_ = odd; }

  /// Ends a step: what was written is now what arrives.
  void advance() { odd_ = !odd_; }

  template <class L, class Real>
  struct Row {
    std::array<Real*, L::Q> in, out;  ///< [q], valid for x = 0 … nx-1
  };

  /// Pointers of row (y, z) and its ends made ready. Call `close` after the row was swept.
  template <class L, class Real>
  Row<L, Real> open(Populations& f, int y, int z) const {
    Row<L, Real> row;
    row.in[0] = row.out[0] = f.row<Real>(0, y, z);
    unroll<L::pairs>([&](auto p) {
      constexpr int i = 2 * p + 1;
      const Pair<Real> pair = places<L, Real, i>(f, y, z);
      if constexpr (L::c[i][0] != 0) enter<L, Real, i>(f, y, z, pair);
      row.in[i] = row.out[i + 1] = pair.own;
      row.in[i + 1] = row.out[i] = pair.next;
    });
    return row;
  }

  template <class L, class Real>
  void close(Populations& f, int y, int z) const {
    if (faces_[0][0] != Face::Periodic) return;
    unroll<L::pairs>([&](auto p) {
      constexpr int i = 2 * p + 1;
      if constexpr (L::c[i][0] != 0)
        if (const auto pair = places<L, Real, i>(f, y, z); !pair.next_is_wall)
          pair.next[-1] = pair.next[f.nx() - 1];
    });
  }

  /// The population that arrives at cell (x, y, z) along direction q in the coming step. The one
  /// accessor for everything that is not the sweep: initial state, boundaries, output, tests.
  Population arriving(Populations& f, int q, int x, int y, int z = 0) const {
    return {f, place(f, q, x, y, z)};
  }
  double arriving(const Populations& f, int q, int x, int y, int z = 0) const {
    return f.get(place(f, q, x, y, z));
  }

  /// The two slots of a pair in the coming step: of the cell itself, and of the cell at x + c_i.
  struct Slots {
    int own, next;
  };
  Slots slots(int i) const { return odd_ ? Slots{i, i + 1} : Slots{i + 1, i}; }

 private:
  template <class Real>
  struct Pair {
    Real *own, *next;  ///< slot of the cell itself, and of the cell at x + c_i
    bool own_is_wall, next_is_wall;
  };

  static bool out(int v, int n, const std::array<Face, 2>& faces, Face kind) {
    return (v < 0 && faces[0] == kind) || (v >= n && faces[1] == kind);
  }
  bool beyond(const Populations& f, int y, int z) const {
    return out(y, f.ny(), faces_[1], Face::Wall) || out(z, f.nz(), faces_[2], Face::Wall);
  }
  int wrap_y(const Populations& f, int y) const {
    return out(y, f.ny(), faces_[1], Face::Periodic) ? (y < 0 ? f.ny() - 1 : 0) : y;
  }
  int wrap_z(const Populations& f, int z) const {
    return out(z, f.nz(), faces_[2], Face::Periodic) ? (z < 0 ? f.nz() - 1 : 0) : z;
  }

  std::ptrdiff_t place(const Populations& f, int q, int x, int y, int z) const {
    if (q == 0) return f.start(0, y, z) + x;
    const int i = q - (q + 1) % 2;  // first of the pair
    const int* c = f.lattice().c[i];
    const auto [a, b] = slots(i);
    if (q == i) {
      if (beyond(f, y - c[1], z - c[2])) return f.start(i, y, z) + x;
      const bool wall = x - c[0] < 0 && faces_[0][0] == Face::Wall;
      return f.start(wall ? b : a, y, z) + x;
    }
    const int to_x = x + c[0], to_y = y + c[1], to_z = z + c[2];
    if (beyond(f, to_y, to_z)) return f.start(i, to_y, to_z) + to_x;
    const int wy = wrap_y(f, to_y), wz = wrap_z(f, to_z);
    if (to_x < f.nx() || faces_[0][1] == Face::Neighbour) return f.start(b, wy, wz) + to_x;
    return faces_[0][1] == Face::Wall ? f.start(a, wy, wz) + f.nx() : f.start(b, wy, wz);
  }

  template <class L, class Real, int i>
  Pair<Real> places(Populations& f, int y, int z) const {
    constexpr int cx = L::c[i][0], cy = L::c[i][1], cz = L::c[i][2];
    const auto [a, b] = slots(i);
    Pair<Real> pair;
    pair.own_is_wall = beyond(f, y - cy, z - cz);
    pair.next_is_wall = beyond(f, y + cy, z + cz);
    pair.own = f.row<Real>(pair.own_is_wall ? i : a, y, z);
    pair.next = (pair.next_is_wall ? f.row<Real>(i, y + cy, z + cz)
                                   : f.row<Real>(b, wrap_y(f, y + cy), wrap_z(f, z + cz))) +
                cx;
    return pair;
  }

  /// Brings to the ends of row (y, z) what arrives there through the sides in x.
  template <class L, class Real, int i>
  void enter(Populations& f, int y, int z, const Pair<Real>& pair) const {
    const int n = f.nx();
    if (faces_[0][0] == Face::Periodic) {
      if (!pair.next_is_wall) pair.next[n - 1] = pair.next[-1];
      return;
    }
    const auto [a, b] = slots(i);
    if (faces_[0][0] == Face::Wall && !pair.own_is_wall) pair.own[0] = f.row<Real>(b, y, z)[0];
    if (faces_[0][1] == Face::Wall && !pair.next_is_wall)
      pair.next[n - 1] = f.row<Real>(a, wrap_y(f, y + L::c[i][1]), wrap_z(f, z + L::c[i][2]))[n];
  }

  Faces faces_;
  bool odd_ = false;
};

}  // namespace lbm
