// SPDX-License-Identifier: GPL-2.0-or-later
#include "lbm_solver/lattice/lattice.h"

#include <algorithm>
#include <array>

namespace lbm {
namespace {

constexpr double kRoundOff = 1e-15;  // of sums of up to 27 weights, which add up to 1

constexpr bool nearly(double a, double b) {
  return a - b < kRoundOff && b - a < kRoundOff;
}

/// The order of directions that kernels and streaming rely on: rest, then +x -x +y -y (+z -z), then
/// the others in opposite pairs, of which the first one points as `opposite` says.
template <class L>
constexpr bool in_order() {
  bool good = L::Q == 2 * L::pairs + 1 && L::c[0][0] == 0 && L::c[0][1] == 0 && L::c[0][2] == 0;
  for (int i = 1; i < L::Q; i += 2) {
    const int(&c)[3] = L::c[i];
    good = good && (c[0] != 0 ? c[0] : c[1] != 0 ? c[1] : c[2]) == 1;
    for (int a = 0; a < 3; ++a) {
      good = good && L::c[i + 1][a] == -c[a] && c[a] * c[a] <= 1;
      if (i < 2 * L::D) good = good && c[a] == (i == 2 * a + 1);
    }
  }
  return good;
}

/// The moments of the weights, on which the viscosity (τ - ½)/3 and its isotropy rest:
///   Σ w_i = 1,   Σ w_i c_a c_b = δ_ab/3,   Σ w_i c_a c_b c_c c_d = (δ_ab δ_cd + δ_ac δ_bd + δ_ad
///   δ_bc)/9; those of odd order vanish, since opposite directions weigh the same.
template <class L>
constexpr bool weighs_right() {
  bool good = true;
  double all = 0.0;
  for (int i = 0; i < L::Q; ++i) {
    all += L::w[i];
    good = good && L::w[i] == L::w[opposite(i)];
  }
  const auto same = [](int a, int b) { return a == b ? 1.0 : 0.0; };
  for (int a = 0; a < L::D; ++a)
    for (int b = 0; b < L::D; ++b) {
      double second = 0.0;
      for (int i = 0; i < L::Q; ++i) second += L::w[i] * L::c[i][a] * L::c[i][b];
      good = good && nearly(second, same(a, b) / 3.0);
      for (int c = 0; c < L::D; ++c)
        for (int d = 0; d < L::D; ++d) {
          double fourth = 0.0;
          for (int i = 0; i < L::Q; ++i)
            fourth += L::w[i] * L::c[i][a] * L::c[i][b] * L::c[i][c] * L::c[i][d];
          good = good && nearly(fourth, (same(a, b) * same(c, d) + same(a, c) * same(b, d) +
                                         same(a, d) * same(b, c)) /
                                            9.0);
        }
    }
  return good && nearly(all, 1.0);
}

template <class... L>
constexpr std::array<Lattice, sizeof...(L)> all_of() {
  static_assert((in_order<L>() && ...), "the order of a set's directions: see in_order");
  static_assert((weighs_right<L>() && ...), "the weights of a set: see weighs_right");
  return {to_lattice<L>()...};
}

constexpr auto kLattices = all_of<D2Q9, D3Q19, D3Q27>();
static_assert(kLattices.size() == std::size(ChoiceNames<VelocitySet>::table),
              "every set that a scene can name is in this list");

}  // namespace

const Lattice& lattice(VelocitySet id) {
  return *std::ranges::find(kLattices, id, &Lattice::id);
}

}  // namespace lbm
