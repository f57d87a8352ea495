// SPDX-License-Identifier: GPL-2.0-or-later
/// The value types that kernels are written on: SIMD packs of doubles or floats, or a plain double
/// as reference. A policy takes `V` and never asks which it is.
#pragma once

#include <experimental/simd>
#include <type_traits>
#include <utility>

#if defined(__SSE2__)
#include <immintrin.h>
#endif

namespace lbm {

using Pack = std::experimental::native_simd<double>;
inline constexpr int kPackWidth = static_cast<int>(Pack::size());

/// A pack of floats that takes the doubles of a formula as they are written.
class SinglePack {
 public:
  using Lanes = std::experimental::native_simd<float>;
  using value_type = float;
  using mask_type = Lanes::mask_type;
  static constexpr int size() { return static_cast<int>(Lanes::size()); }

  SinglePack() = default;
  [[gnu::always_inline]] SinglePack(double v) : lanes_(static_cast<float>(v)) {}
  [[gnu::always_inline]] SinglePack(const Lanes& lanes) : lanes_(lanes) {}
  [[gnu::always_inline]] const Lanes& lanes() const { return lanes_; }
  [[gnu::always_inline]] Lanes& lanes() { return lanes_; }

  [[gnu::always_inline]] SinglePack operator-() const { return -lanes_; }
  [[gnu::always_inline]] SinglePack& operator+=(const SinglePack& b) {
    lanes_ += b.lanes_;
    return *this;
  }
  [[gnu::always_inline]] SinglePack& operator-=(const SinglePack& b) {
    lanes_ -= b.lanes_;
    return *this;
  }
  [[gnu::always_inline]] SinglePack& operator*=(const SinglePack& b) {
    lanes_ *= b.lanes_;
    return *this;
  }
  [[gnu::always_inline]] friend SinglePack operator+(SinglePack a, const SinglePack& b) {
    return a += b;
  }
  [[gnu::always_inline]] friend SinglePack operator-(SinglePack a, const SinglePack& b) {
    return a -= b;
  }
  [[gnu::always_inline]] friend SinglePack operator*(SinglePack a, const SinglePack& b) {
    return a *= b;
  }
  [[gnu::always_inline]] friend SinglePack operator/(const SinglePack& a, const SinglePack& b) {
    return a.lanes_ / b.lanes_;
  }
  [[gnu::always_inline]] friend SinglePack sqrt(const SinglePack& a) {
    return std::experimental::sqrt(a.lanes_);
  }
  [[gnu::always_inline]] friend SinglePack min(const SinglePack& a, const SinglePack& b) {
    return std::experimental::min(a.lanes_, b.lanes_);
  }
  [[gnu::always_inline]] friend mask_type operator>=(const SinglePack& a, const SinglePack& b) {
    return a.lanes_ >= b.lanes_;
  }

 private:
  Lanes lanes_;
};

/// The pack that cells are swept with where populations are stored as `Real`.
template <class Real>
using PackOf = std::conditional_t<std::is_same_v<Real, float>, SinglePack, Pack>;

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

/// Stores the sums over the lanes of up to eight packs, all found at once where a pack has eight
/// lanes: in each of three rounds neighbours are added, which makes one pack of two.
template <class... Packs>
[[gnu::always_inline]] inline void store_sums(double* to, const Packs&... packs) {
#if defined(__AVX512F__)
  constexpr int n = sizeof...(Packs);
  using Vector = __m512d;
  static_assert(n <= 8 && kPackWidth == 8);
  const Vector in[8] = {static_cast<Vector>(packs)...};
  Vector pairs[4] = {}, fours[2];
  for (int i = 0; i < (n + 1) / 2; ++i) {
    const Vector &a = in[2 * i], &b = in[2 * i + 1];
    pairs[i] = __builtin_shufflevector(a, b, 0, 8, 2, 10, 4, 12, 6, 14) +
               __builtin_shufflevector(a, b, 1, 9, 3, 11, 5, 13, 7, 15);
  }
  for (int i = 0; i < 2; ++i) {
    const Vector &a = pairs[2 * i], &b = pairs[2 * i + 1];
    fours[i] = __builtin_shufflevector(a, b, 0, 1, 8, 9, 4, 5, 12, 13) +
               __builtin_shufflevector(a, b, 2, 3, 10, 11, 6, 7, 14, 15);
  }
  const Vector all = __builtin_shufflevector(fours[0], fours[1], 0, 1, 2, 3, 8, 9, 10, 11) +
                     __builtin_shufflevector(fours[0], fours[1], 4, 5, 6, 7, 12, 13, 14, 15);
  _mm512_mask_storeu_pd(to, (1U << n) - 1U, all);
#else
  ((*to++ = std::experimental::reduce(packs)), ...);
#endif
}

/// The SIMD lanes of a pack.
[[gnu::always_inline]] inline Pack& lanes_of(Pack& v) {
  return v;
}
[[gnu::always_inline]] inline const Pack& lanes_of(const Pack& v) {
  return v;
}
[[gnu::always_inline]] inline SinglePack::Lanes& lanes_of(SinglePack& v) {
  return v.lanes();
}
[[gnu::always_inline]] inline const SinglePack::Lanes& lanes_of(const SinglePack& v) {
  return v.lanes();
}

/// In each lane `yes` where the mask is set, `no` elsewhere.
template <class V>
[[gnu::always_inline]] inline V select(const typename V::mask_type& which, const V& yes,
                                       const V& no) {
  V value = no;
  where(which, lanes_of(value)) = lanes_of(yes);
  return value;
}

/// Four numbers, of which each lane of a pack takes one.
class alignas(64) LaneChoice {
 public:
  LaneChoice() = default;
  LaneChoice(double zero, double one, double two, double three)
      : at_{zero, one, two, three}, singles_{float(zero), float(one), float(two), float(three)} {}

  template <class V>
  struct Which {
    typename V::mask_type one, two, three;
  };
  /// By whole numbers 0 … 3; from each lane of v the fraction is cut off.
  template <class V>
  [[gnu::always_inline]] static Which<V> which(const V& v) {
    return {v >= V(1.0), v >= V(2.0), v >= V(3.0)};
  }
  template <class V>
  [[gnu::always_inline]] V operator()(const Which<V>& which) const {
    const V below_two = select(which.one, at<V>(1), at<V>(0));
    return select(which.three, at<V>(3), select(which.two, at<V>(2), below_two));
  }

#if defined(__AVX512DQ__)
  [[gnu::always_inline]] static __m512i which(const Pack& v) {
    return _mm512_cvttpd_epi64(static_cast<__m512d>(v));
  }
  [[gnu::always_inline]] Pack operator()(const __m512i& which) const {
    return Pack(_mm512_permutexvar_pd(which, _mm512_load_pd(at_)));
  }
#endif

 private:
  template <class V>
  [[gnu::always_inline]] V at(int k) const {
    if constexpr (std::is_same_v<V, SinglePack>)
      return SinglePack::Lanes(singles_[k]);
    else
      return V(at_[k]);
  }

#if defined(__AVX512DQ__)
  double at_[8] = {};  // a whole pack
#else
  double at_[4] = {};
#endif
  float singles_[4] = {};
};

/// The lanes of two packs of doubles as one of floats, and back.
class JoinedPacks {
  static constexpr std::size_t n = Pack::size();
  static_assert(SinglePack::size() == 2 * n);
  using Doubles [[gnu::vector_size(sizeof(Pack))]] = double;
  using Floats [[gnu::vector_size(sizeof(Pack))]] = float;
  using Half [[gnu::vector_size(sizeof(Pack) / 2)]] = float;

 public:
  [[gnu::always_inline]] static SinglePack join(const Pack& low, const Pack& high) {
    return join(std::make_index_sequence<2 * n>(), floats(low), floats(high));
  }
  [[gnu::always_inline]] static Pack low(const SinglePack& v) {
    return part<0>(std::make_index_sequence<n>(), v);
  }
  [[gnu::always_inline]] static Pack high(const SinglePack& v) {
    return part<n>(std::make_index_sequence<n>(), v);
  }

 private:
  [[gnu::always_inline]] static Half floats(const Pack& v) {
    return __builtin_convertvector(static_cast<Doubles>(v), Half);
  }
  template <std::size_t... i>
  [[gnu::always_inline]] static SinglePack join(std::index_sequence<i...>, const Half& low,
                                                const Half& high) {
    return SinglePack::Lanes(Floats(__builtin_shufflevector(low, high, i...)));
  }
  template <std::size_t first, std::size_t... i>
  [[gnu::always_inline]] static Pack part(std::index_sequence<i...>, const SinglePack& v) {
    const Floats all = static_cast<Floats>(v.lanes());
    const Half half = __builtin_shufflevector(all, all, (first + i)...);
    return Pack(__builtin_convertvector(half, Doubles));
  }
};

/// Access to all lanes of a pack. Memory may be of the other precision.
template <class V>
struct AllLanes {
  template <class Real>
  [[gnu::always_inline]] V load(const Real* p) const {
    V v;
    lanes_of(v).copy_from(p, std::experimental::element_aligned);
    return v;
  }
  template <class Real>
  [[gnu::always_inline]] void store(Real* p, const V& v) const {
    lanes_of(v).copy_to(p, std::experimental::element_aligned);
  }
};

/// Access to the first lanes of a pack, for the end of a row: nothing beyond them is read or
/// written.
template <class V>
class FirstLanes {
  using Number = typename V::value_type;
  using Lanes = std::remove_cvref_t<decltype(lanes_of(std::declval<V&>()))>;

 public:
  explicit FirstLanes(int count)
      : mask_(Lanes([](auto lane) { return static_cast<Number>(lane); }) <
              Lanes(static_cast<Number>(count))) {}
  template <class Real>
  [[gnu::always_inline]] V load(const Real* p) const {
    V v(0.0);
    where(mask_, lanes_of(v)).copy_from(p, std::experimental::element_aligned);
    return v;
  }
  template <class Real>
  [[gnu::always_inline]] void store(Real* p, const V& v) const {
    where(mask_, lanes_of(v)).copy_to(p, std::experimental::element_aligned);
  }

 private:
  typename V::mask_type mask_;
};

/// Denormal numbers cost up to a third of the speed and carry no physics: each thread flushes them.
inline void flush_denormals() {
#if defined(__SSE2__)
  _MM_SET_FLUSH_ZERO_MODE(_MM_FLUSH_ZERO_ON);
  _MM_SET_DENORMALS_ZERO_MODE(_MM_DENORMALS_ZERO_ON);
#endif
}

/// Asks for the cache lines of an object that is soon to be read and written.
template <std::size_t bytes>
[[gnu::always_inline]] inline void prefetch_bytes(const void* at) {
  for (std::size_t i = 0; i < bytes; i += 64)
    __builtin_prefetch(static_cast<const char*>(at) + i, 1, 3);
}

}  // namespace lbm
