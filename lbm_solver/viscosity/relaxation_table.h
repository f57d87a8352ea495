// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <functional>
#include <vector>

#include "lbm_solver/base/simd.h"

namespace lbm {

/// Relaxation rate 1/tau(Y) of a viscosity law, Y = (⅔ γ̇ tau)², which is what a cell's stress says
/// of its shear rate γ̇: Y = 2 Q_ab Q_ab / rho² with Q_ab = -⅔ rho tau S_ab without its trace.
///
/// Since γ̇ tau(γ̇) grows with γ̇ wherever the stress does, 1/tau is a function of Y. It is solved for
/// once, on kIntervals straight pieces for each doubling of Y, which are found by the bits of the
/// floating-point number: the error is at most 1.2e-4 of the largest rate, and 4e-3 in the piece in
/// which a law meets a bound. Below and above its range the law is constant.
class RelaxationTable {
 public:
  static constexpr int kBits = 5, kIntervals = 1 << kBits;

  /// @param tau  of a shear rate, lattice units; finite and above ½, at zero shear too
  /// @throws std::invalid_argument where the stress falls with the shear rate
  explicit RelaxationTable(const std::function<double(double)>& tau);

  /// @param y  not negative; what is not a number stays so
  [[gnu::always_inline]] double operator()(double y) const;
  [[gnu::always_inline]] Pack operator()(const Pack& y) const;
  [[gnu::always_inline]] SinglePack operator()(const SinglePack& y) const;

  /// Shear rate at a value of Y.
  double shear_rate(double y) const;
  /// Y of the first and the last piece.
  double lowest() const { return lowest_; }
  double highest() const { return highest_; }
  std::size_t bytes() const { return pieces_.size() * (sizeof(Piece) + sizeof(SinglePiece)); }

 private:
  std::int64_t first_;  // bits of the first piece's Y, without those behind the piece's number
  std::int64_t last_;   // number of the last piece
  double lowest_ = 0.0, highest_ = 0.0;
  /// 1/tau = value + slope Y
  struct alignas(16) Piece {
    double value, slope;
  };
  struct alignas(8) SinglePiece {
    float value, slope;
  };
  std::vector<Piece> pieces_;
  std::vector<SinglePiece> singles_;  // the same
};

inline double RelaxationTable::operator()(double y) const {
  const std::int64_t at = (std::bit_cast<std::int64_t>(y) >> (52 - kBits)) - first_;
  const Piece& piece = pieces_[static_cast<std::size_t>(std::clamp(at, std::int64_t{0}, last_))];
  return piece.value + piece.slope * y;
}

inline double RelaxationTable::shear_rate(double y) const {
  return 1.5 * std::sqrt(y) * (*this)(y);
}

#if defined(__AVX512F__)
// A gather would be the instruction for this; a piece a lane, one after the other, takes half of
// its time here.
inline Pack RelaxationTable::operator()(const Pack& y) const {
  const auto bits = _mm512_castpd_si512(static_cast<__m512d>(y));
  const auto at = _mm512_sub_epi64(_mm512_srai_epi64(bits, 52 - kBits), _mm512_set1_epi64(first_));
  alignas(64) std::int64_t piece[8];
  _mm512_store_si512(piece, _mm512_min_epi64(_mm512_max_epi64(at, _mm512_setzero_si512()),
                                             _mm512_set1_epi64(last_)));
  const auto pair = [&](int lane) { return _mm_load_pd(&pieces_[piece[lane]].value); };
  const auto four = [&](int lane) {
    const auto low = _mm256_insertf128_pd(_mm256_castpd128_pd256(pair(lane)), pair(lane + 1), 1);
    const auto high =
        _mm256_insertf128_pd(_mm256_castpd128_pd256(pair(lane + 2)), pair(lane + 3), 1);
    return _mm512_insertf64x4(_mm512_castpd256_pd512(low), high, 1);
  };
  const auto a = four(0), b = four(4);
  const auto value = _mm512_permutex2var_pd(a, _mm512_set_epi64(14, 12, 10, 8, 6, 4, 2, 0), b);
  const auto slope = _mm512_permutex2var_pd(a, _mm512_set_epi64(15, 13, 11, 9, 7, 5, 3, 1), b);
  return Pack(value) + Pack(slope) * y;
}

inline SinglePack RelaxationTable::operator()(const SinglePack& y) const {
  // a float has the exponents of a double less 1023 - 127
  constexpr std::int64_t less = std::int64_t{1023 - 127} << kBits;
  const auto bits = _mm512_castps_si512(static_cast<__m512>(y.lanes()));
  const auto at = _mm512_sub_epi32(_mm512_srai_epi32(bits, 23 - kBits),
                                   _mm512_set1_epi32(static_cast<int>(first_ - less)));
  alignas(64) std::int32_t piece[16];
  _mm512_store_si512(piece, _mm512_min_epi32(_mm512_max_epi32(at, _mm512_setzero_si512()),
                                             _mm512_set1_epi32(static_cast<int>(last_))));
  const auto eight = [&](int k) {
    const auto pair = [&](int lane) { return std::bit_cast<long long>(singles_[piece[k + lane]]); };
    return _mm512_castsi512_ps(
        _mm512_set_epi64(pair(7), pair(6), pair(5), pair(4), pair(3), pair(2), pair(1), pair(0)));
  };
  const auto a = eight(0), b = eight(8);
  const auto even = _mm512_set_epi32(30, 28, 26, 24, 22, 20, 18, 16, 14, 12, 10, 8, 6, 4, 2, 0);
  const auto odd = _mm512_or_si512(even, _mm512_set1_epi32(1));
  const SinglePack value(SinglePack::Lanes(_mm512_permutex2var_ps(a, even, b)));
  return value + SinglePack(SinglePack::Lanes(_mm512_permutex2var_ps(a, odd, b))) * y;
}
#else
inline Pack RelaxationTable::operator()(const Pack& y) const {
  return Pack([&](auto lane) { return (*this)(static_cast<double>(y[lane])); });
}
inline SinglePack RelaxationTable::operator()(const SinglePack& y) const {
  return SinglePack(SinglePack::Lanes([&](auto lane) {
    return static_cast<float>((*this)(static_cast<double>(y.lanes()[lane])));
  }));
}
#endif

}  // namespace lbm
