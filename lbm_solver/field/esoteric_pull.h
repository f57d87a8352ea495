// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <array>

#include "lbm_solver/base/unroll.h"
#include "lbm_solver/field/populations.h"

namespace lbm {

/// In-place streaming ("Esoteric Pull", Lehmann 2022). A cell reads the populations that arrive and
/// writes those that leave at the same nine memory places, so one lattice suffices and rows may be
/// swept in any order. For a pair (i, i+1) with i+1 opposite to i:
///
///   even step   f_i   at slot i+1 of the cell itself      f_i+1 at slot i   of the cell at x + c_i
///   odd step    f_i   at slot i   of the cell itself      f_i+1 at slot i+1 of the cell at x + c_i
///
/// After collision the two change places. What a cell wrote is then where its neighbour reads.
///
/// A half-way bounce-back wall returns f_i* as f_opp(i) to the same cell: the places beyond a wall
/// in y keep their slot at every parity (a choice of pointer), those beyond a wall in x lie at the
/// ends of a row and are copied from the other slot before the row is swept.
///
/// This is the only file that knows the pattern.
class EsotericPull {
 public:
  EsotericPull(Side x, Side y) : x_(x), y_(y) {}

  Side x() const { return x_; }
  Side y() const { return y_; }
  bool odd() const { return odd_; }
  void set_odd(bool odd) { odd_ = odd; }

  /// Ends a step: what was written is now what arrives.
  void advance() { odd_ = !odd_; }

  struct Row {
    std::array<double*, D2Q9::Q> in, out;  ///< [q], valid for x = 0 … nx-1
  };

  /// Pointers of row y and its ends made ready. Call `close` after the row was swept.
  Row open(Populations& f, int y) const {
    Row row;
    row.in[0] = row.out[0] = f.row(0, y);
    unroll<D2Q9::pairs>([&](auto p) {
      constexpr int i = 2 * p + 1;
      const Pair pair = places<i>(f, y);
      if constexpr (D2Q9::c[i][0] != 0) enter<i>(f, y, pair);
      row.in[i] = row.out[i + 1] = pair.own;
      row.in[i + 1] = row.out[i] = pair.next;
    });
    return row;
  }

  void close(Populations& f, int y) const {
    if (x_ == Side::Wall) return;
    unroll<D2Q9::pairs>([&](auto p) {
      constexpr int i = 2 * p + 1;
      if constexpr (D2Q9::c[i][0] != 0)
        if (const Pair pair = places<i>(f, y); !pair.next_is_wall)
          pair.next[-1] = pair.next[f.nx() - 1];
    });
  }

  /// Place of the population that arrives at cell (x, y) along direction q in the coming step. The
  /// one accessor for everything that is not the sweep: initial state, output, tests.
  double& arriving(Populations& f, int q, int x, int y) const {
    if (q == 0) return f.row(0, y)[x];
    const int i = q - (q + 1) % 2;  // first of the pair
    const int cx = D2Q9::c[i][0], cy = D2Q9::c[i][1];
    const int a = odd_ ? i : i + 1, b = odd_ ? i + 1 : i;
    if (q == i) {
      if (beyond(f, y - cy)) return f.row(i, y)[x];
      return f.row(x_ == Side::Wall && x - cx < 0 ? b : a, y)[x];
    }
    if (beyond(f, y + cy)) return f.row(i, y + cy)[x + cx];
    const int to = wrap(f, y + cy);
    if (x + cx < f.nx()) return f.row(b, to)[x + cx];
    return x_ == Side::Wall ? f.row(a, to)[f.nx()] : f.row(b, to)[0];
  }
  double arriving(const Populations& f, int q, int x, int y) const {
    return arriving(const_cast<Populations&>(f), q, x, y);
  }

 private:
  struct Pair {
    double *own, *next;  ///< slot of the cell itself, and of the cell at x + c_i
    bool own_is_wall, next_is_wall;
  };

  bool beyond(const Populations& f, int y) const {
    return y_ == Side::Wall && (y < 0 || y >= f.ny());
  }
  static int wrap(const Populations& f, int y) { return y < 0 ? f.ny() - 1 : y == f.ny() ? 0 : y; }

  template <int i>
  Pair places(Populations& f, int y) const {
    constexpr int cx = D2Q9::c[i][0], cy = D2Q9::c[i][1];
    const int a = odd_ ? i : i + 1, b = odd_ ? i + 1 : i;
    Pair pair;
    pair.own_is_wall = beyond(f, y - cy);
    pair.next_is_wall = beyond(f, y + cy);
    pair.own = f.row(pair.own_is_wall ? i : a, y);
    pair.next = (pair.next_is_wall ? f.row(i, y + cy) : f.row(b, wrap(f, y + cy))) + cx;
    return pair;
  }

  /// Brings to the ends of row y what arrives there through the sides in x.
  template <int i>
  void enter(Populations& f, int y, const Pair& pair) const {
    const int n = f.nx();
    if (x_ == Side::Periodic) {
      if (!pair.next_is_wall) pair.next[n - 1] = pair.next[-1];
      return;
    }
    const int a = odd_ ? i : i + 1, b = odd_ ? i + 1 : i;
    if (!pair.own_is_wall) pair.own[0] = f.row(b, y)[0];
    if (!pair.next_is_wall) pair.next[n - 1] = f.row(a, wrap(f, y + D2Q9::c[i][1]))[n];
  }

  Side x_, y_;
  bool odd_ = false;
};

}  // namespace lbm
