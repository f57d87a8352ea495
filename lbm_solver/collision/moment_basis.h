// SPDX-License-Identifier: GPL-2.0-or-later
/// From moments up to the second power of each axis back to populations, for the operators that
/// collide in moment space.
#pragma once

#include "lbm_solver/collision/tensors.h"

namespace lbm {

/// Coefficients k_abc of powers a, b, c = 0, 1, 2 of the axes. A two-dimensional set has c = 0
/// alone, and D3Q19, which has no corners, none with three powers above zero.
template <class L, class V>
struct Coefficients {
  static constexpr int depth = L::D == 3 ? 3 : 1;
  V at[3][3][depth];

  static constexpr bool exists(int a, int b, int c) {
    return c < depth && (L::Q != 19 || a * b * c == 0);
  }
  template <int axis>
  static constexpr bool line_exists(int b, int c) {
    return axis == 0 ? exists(2, b, c) : axis == 1 ? exists(b, 2, c) : exists(b, c, 2);
  }
  /// Calls f(a, b, c) for every coefficient.
  template <class F>
  [[gnu::always_inline]] static void each(F&& f) {
    unroll<3>([&](auto a) __attribute__((always_inline)) {
      unroll<3>([&](auto b) __attribute__((always_inline)) {
        unroll<depth>([&](auto c) __attribute__((always_inline)) {
          if constexpr (exists(a, b, c)) f(a, b, c);
        });
      });
    });
  }
  /// Calls f(k_0, k_1, k_2) for every line of coefficients along an axis that has all three.
  template <int axis, class F>
  [[gnu::always_inline]] void each_line(F&& f) {
    unroll<3>([&](auto b) __attribute__((always_inline)) {
      unroll<3>([&](auto c) __attribute__((always_inline)) {
        if constexpr (line_exists<axis>(b, c)) {
          if constexpr (axis == 0) f(at[0][b][c], at[1][b][c], at[2][b][c]);
          if constexpr (axis == 1) f(at[b][0][c], at[b][1][c], at[b][2][c]);
          if constexpr (axis == 2) f(at[b][c][0], at[b][c][1], at[b][c][2]);
        }
      });
    });
  }
};

/// Populations of a product set (D2Q9, D3Q27) from raw moments Σ c_x^a c_y^b c_z^c f: an axis takes
/// m_0 - m_2 at rest and ½(m_2 ± m_1) along it.
template <class L, class V>
[[gnu::always_inline]] inline void product_populations(Coefficients<L, V>& m, V (&f)[L::Q]) {
  unroll<L::D>([&](auto axis) __attribute__((always_inline)) {
    m.template each_line<axis>([](V & m0, V & m1, V & m2) __attribute__((always_inline)) {
      const V rest = m0 - m2;
      m0 = V(0.5) * (m2 - m1);
      m2 = V(0.5) * (m2 + m1);
      m1 = rest;
    });
  });
  unroll<L::Q>([&](auto q) __attribute__((always_inline)) {
    f[q] = m.at[L::c[q][0] + 1][L::c[q][1] + 1][L::D == 3 ? L::c[q][2] + 1 : 0];
  });
}

/// Populations of D3Q19 from raw moments: edges from the moments of their plane, the rest of each
/// axis and of the whole to the faces and the centre.
template <class L, class V>
[[gnu::always_inline]] inline void edge_populations(const Coefficients<L, V>& m, V (&f)[L::Q]) {
  /// Moment with powers p of axis a and q of axis b.
  const auto get = [&](auto a, auto p, auto b, auto q) __attribute__((always_inline))->const V& {
    constexpr int x = a == 0 ? int(p) : b == 0 ? int(q) : 0;
    constexpr int y = a == 1 ? int(p) : b == 1 ? int(q) : 0;
    constexpr int z = a == 2 ? int(p) : b == 2 ? int(q) : 0;
    return m.at[x][y][z];
  };
  constexpr std::integral_constant<int, 0> zero{};
  constexpr std::integral_constant<int, 1> one{};
  constexpr std::integral_constant<int, 2> two{};
  V centre = m.at[0][0][0];
  unroll<3>([&](auto a) __attribute__((always_inline)) {
    constexpr std::integral_constant<int, (a + 1) % 3> b{};
    constexpr std::integral_constant<int, (a + 2) % 3> d{};
    const V even = get(a, two, b, zero) - get(a, two, b, two) - get(a, two, d, two);
    const V odd = get(a, one, b, zero) - get(a, one, b, two) - get(a, one, d, two);
    f[direction<L>(a == 0, a == 1, a == 2)] = V(0.5) * (even + odd);
    f[direction<L>(-(a == 0), -(a == 1), -(a == 2))] = V(0.5) * (even - odd);
    centre -= get(a, two, b, zero) - get(a, two, b, two);
    unroll<4>([&](auto corner) __attribute__((always_inline)) {
      constexpr int s = corner % 2 ? -1 : 1, t = corner / 2 ? -1 : 1;  // signs along a and b
      const V sum = get(a, two, b, two) + V(s) * get(a, one, b, two) + V(t) * get(a, two, b, one) +
                    V(s * t) * get(a, one, b, one);
      constexpr int x = a == 0   ? s
                        : b == 0 ? t
                                 : 0,
                    y = a == 1   ? s
                        : b == 1 ? t
                                 : 0,
                    z = a == 2   ? s
                        : b == 2 ? t
                                 : 0;
      f[direction<L>(x, y, z)] = V(0.25) * sum;
    });
  });
  f[0] = centre;
}

/// Populations that have these raw moments.
template <class L, class V>
[[gnu::always_inline]] inline void to_populations(Coefficients<L, V>& m, V (&f)[L::Q]) {
  if constexpr (L::Q == 19)
    edge_populations<L>(m, f);
  else
    product_populations<L>(m, f);
}

}  // namespace lbm
