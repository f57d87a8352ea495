// SPDX-License-Identifier: GPL-2.0-or-later
/// The value type that kernels are written on: a SIMD pack, or a plain double as reference. A
/// policy takes `V` and never asks which it is.
#pragma once

#include <experimental/simd>

#if defined(__SSE2__)
#include <pmmintrin.h>
#include <xmmintrin.h>
#endif

namespace lbm {

using Pack = std::experimental::native_simd<double>;
inline constexpr int kPackWidth = static_cast<int>(Pack::size());

template <class V>
[[gnu::always_inline]] inline V load(const double* p) {
  if constexpr (std::is_same_v<V, double>)
    return *p;
  else
    return V(p, std::experimental::element_aligned);
}

[[gnu::always_inline]] inline void store(double* p, double v) {
  *p = v;
}
[[gnu::always_inline]] inline void store(double* p, const Pack& v) {
  v.copy_to(p, std::experimental::element_aligned);
}

/// 0, 1, 2, … in the lanes of a pack.
inline Pack lane_numbers() {
  return Pack([](auto lane) { return static_cast<double>(lane); });
}

/// Access to all lanes of a pack.
struct AllLanes {
  [[gnu::always_inline]] Pack load(const double* p) const { return lbm::load<Pack>(p); }
  [[gnu::always_inline]] void store(double* p, const Pack& v) const { lbm::store(p, v); }
};

/// Access to the first lanes of a pack, for the end of a row: nothing beyond them is read or
/// written.
class FirstLanes {
 public:
  explicit FirstLanes(int count) : mask_(lane_numbers() < Pack(static_cast<double>(count))) {}
  [[gnu::always_inline]] Pack load(const double* p) const {
    Pack v(0.0);
    where(mask_, v).copy_from(p, std::experimental::element_aligned);
    return v;
  }
  [[gnu::always_inline]] void store(double* p, const Pack& v) const {
    where(mask_, v).copy_to(p, std::experimental::element_aligned);
  }

 private:
  Pack::mask_type mask_;
};

/// Denormal numbers cost up to a third of the speed and carry no physics: each thread flushes them.
inline void flush_denormals() {
#if defined(__SSE2__)
  _MM_SET_FLUSH_ZERO_MODE(_MM_FLUSH_ZERO_ON);
  _MM_SET_DENORMALS_ZERO_MODE(_MM_DENORMALS_ZERO_ON);
#endif
}

}  // namespace lbm
