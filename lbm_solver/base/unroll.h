// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <utility>

namespace lbm {

/// Calls f(integral_constant<int, 0>) … f(integral_constant<int, N-1>), unrolled by the compiler.
/// Every loop over lattice directions goes through this: written as an equation, as fast as by
/// hand.
template <int N, class F>
[[gnu::always_inline]] inline void unroll(F&& f) {
  [&]<int... I>(std::integer_sequence<int, I...>) __attribute__((always_inline)) {
    (f(std::integral_constant<int, I>{}), ...);
  }
  (std::make_integer_sequence<int, N>{});
}

}  // namespace lbm
