// SPDX-License-Identifier: GPL-2.0-or-later
/// The velocity sets. Kernels take one as a type, so that every loop over its directions is
/// unrolled; passes over cells and links take `Lattice`, the same numbers at run time.
#pragma once

#include "lbm_solver/base/choices.h"

namespace lbm {

/// Direction 0 rests; (1,2), (3,4), … are opposite pairs. The first of each points to +x, or, where
/// it has no part along x, to +y, or to +z: in-place streaming relies on that order.
constexpr int opposite(int q) {
  return q == 0 ? 0 : ((q - 1) ^ 1) + 1;
}

/// Velocities c, weights w, speed of sound c_s² = 1/3.
struct D2Q9 {
  static constexpr VelocitySet id = VelocitySet::D2Q9;
  static constexpr int D = 2, Q = 9, pairs = 4;
  static constexpr int c[Q][3] = {{0, 0, 0}, {1, 0, 0},   {-1, 0, 0}, {0, 1, 0}, {0, -1, 0},
                                  {1, 1, 0}, {-1, -1, 0}, {1, -1, 0}, {-1, 1, 0}};
  static constexpr double w[Q] = {4.0 / 9,  1.0 / 9,  1.0 / 9,  1.0 / 9, 1.0 / 9,
                                  1.0 / 36, 1.0 / 36, 1.0 / 36, 1.0 / 36};
};

/// Nineteen velocities: no corners of the cube.
struct D3Q19 {
  static constexpr VelocitySet id = VelocitySet::D3Q19;
  static constexpr int D = 3, Q = 19, pairs = 9;
  static constexpr int c[Q][3] = {{0, 0, 0},  {1, 0, 0},   {-1, 0, 0},  {0, 1, 0},   {0, -1, 0},
                                  {0, 0, 1},  {0, 0, -1},  {1, 1, 0},   {-1, -1, 0}, {1, -1, 0},
                                  {-1, 1, 0}, {1, 0, 1},   {-1, 0, -1}, {1, 0, -1},  {-1, 0, 1},
                                  {0, 1, 1},  {0, -1, -1}, {0, 1, -1},  {0, -1, 1}};
  static constexpr double w[Q] = {1.0 / 3,  1.0 / 18, 1.0 / 18, 1.0 / 18, 1.0 / 18,
                                  1.0 / 18, 1.0 / 18, 1.0 / 36, 1.0 / 36, 1.0 / 36,
                                  1.0 / 36, 1.0 / 36, 1.0 / 36, 1.0 / 36, 1.0 / 36,
                                  1.0 / 36, 1.0 / 36, 1.0 / 36, 1.0 / 36};
};

/// All twenty-seven: the product of three one-dimensional sets.
struct D3Q27 {
  static constexpr VelocitySet id = VelocitySet::D3Q27;
  static constexpr int D = 3, Q = 27, pairs = 13;
  static constexpr int c[Q][3] = {
      {0, 0, 0},  {1, 0, 0},   {-1, 0, 0},  {0, 1, 0},   {0, -1, 0},  {0, 0, 1},   {0, 0, -1},
      {1, 1, 0},  {-1, -1, 0}, {1, -1, 0},  {-1, 1, 0},  {1, 0, 1},   {-1, 0, -1}, {1, 0, -1},
      {-1, 0, 1}, {0, 1, 1},   {0, -1, -1}, {0, 1, -1},  {0, -1, 1},  {1, 1, 1},   {-1, -1, -1},
      {1, 1, -1}, {-1, -1, 1}, {1, -1, 1},  {-1, 1, -1}, {1, -1, -1}, {-1, 1, 1}};
  static constexpr double w[Q] = {8.0 / 27,  2.0 / 27,  2.0 / 27,  2.0 / 27,  2.0 / 27,  2.0 / 27,
                                  2.0 / 27,  1.0 / 54,  1.0 / 54,  1.0 / 54,  1.0 / 54,  1.0 / 54,
                                  1.0 / 54,  1.0 / 54,  1.0 / 54,  1.0 / 54,  1.0 / 54,  1.0 / 54,
                                  1.0 / 54,  1.0 / 216, 1.0 / 216, 1.0 / 216, 1.0 / 216, 1.0 / 216,
                                  1.0 / 216, 1.0 / 216, 1.0 / 216};
};

/// Direction of a velocity in a set, -1 where it has none.
template <class L>
constexpr int direction(int x, int y, int z) {
  for (int q = 0; q < L::Q; ++q)
    if (L::c[q][0] == x && L::c[q][1] == y && L::c[q][2] == z) return q;
  return -1;
}

/// A velocity set at run time.
struct Lattice {
  VelocitySet id;
  int D, Q;
  const int (*c)[3];
  const double* w;
};

template <class L>
constexpr Lattice to_lattice() {
  return {L::id, L::D, L::Q, L::c, L::w};
}

const Lattice& lattice(VelocitySet id);

}  // namespace lbm
