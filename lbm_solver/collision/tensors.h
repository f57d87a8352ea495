// SPDX-License-Identifier: GPL-2.0-or-later
/// Vectors and symmetric tensors of a cell, for any velocity set L and value type V.
#pragma once

#include "lbm_solver/base/unroll.h"
#include "lbm_solver/lattice/lattice.h"

namespace lbm {

/// Even and odd half of a pair of opposite populations: f_i = even + odd, f_{i+1} = even - odd.
template <class V>
struct Halves {
  V even, odd;
};

/// A vector with one component an axis of the lattice.
template <class L, class V>
struct Vector {
  V at[L::D];
  [[gnu::always_inline]] V& operator[](int a) { return at[a]; }
  [[gnu::always_inline]] const V& operator[](int a) const { return at[a]; }
};

/// c_i · v for the first direction i of a pair, whose first part that is not zero is +1.
template <class L, int i, class V>
[[gnu::always_inline]] inline V along(const Vector<L, V>& v) {
  constexpr int first = L::c[i][0] != 0 ? 0 : L::c[i][1] != 0 ? 1 : 2;
  V sum = v[first];
  unroll<L::D>([&](auto a) __attribute__((always_inline)) {
    if constexpr (a > first && L::c[i][a] == 1) sum += v[a];
    if constexpr (a > first && L::c[i][a] == -1) sum -= v[a];
  });
  return sum;
}

template <class L, class V>
[[gnu::always_inline]] inline V dot(const Vector<L, V>& a, const Vector<L, V>& b) {
  V sum = a[0] * b[0];
  unroll<L::D - 1>([&](auto k) __attribute__((always_inline)) { sum += a[k + 1] * b[k + 1]; });
  return sum;
}

/// A symmetric second-order tensor.
template <class L, class V>
struct Symmetric {
  static constexpr int size = L::D * (L::D + 1) / 2;
  V at[size];  ///< xx yy (zz) xy (xz yz)

  static constexpr int place(int a, int b) { return a == b ? a : L::D + a + b - 1; }
  template <int a, int b>
  [[gnu::always_inline]] V& get() {
    return at[place(a, b)];
  }
  template <int a, int b>
  [[gnu::always_inline]] const V& get() const {
    return at[place(a, b)];
  }
  [[gnu::always_inline]] V trace() const {
    V sum = at[0];
    unroll<L::D - 1>([&](auto a) __attribute__((always_inline)) { sum += at[a + 1]; });
    return sum;
  }
  /// Σ_ab c_ia c_ib T_ab
  template <int i>
  [[gnu::always_inline]] V along() const {
    constexpr int first = L::c[i][0] != 0 ? 0 : L::c[i][1] != 0 ? 1 : 2;
    V sum = at[first];
    each_pair([&](auto a, auto b) __attribute__((always_inline)) {
      constexpr int c = L::c[i][a] * L::c[i][b];
      if constexpr (a == b && a > first && c != 0) sum += at[a];
      if constexpr (a != b && c != 0) sum += V(2.0 * c) * at[place(a, b)];
    });
    return sum;
  }
  /// Calls f(a, b) for a ≤ b: the diagonal first.
  template <class F>
  [[gnu::always_inline]] static void each_pair(F&& f) {
    unroll<L::D>([&](auto a) __attribute__((always_inline)) { f(a, a); });
    unroll<L::D>([&](auto a) __attribute__((always_inline)) {
      unroll<L::D>([&](auto b) __attribute__((always_inline)) {
        if constexpr (a < b) f(a, b);
      });
    });
  }
};

}  // namespace lbm
