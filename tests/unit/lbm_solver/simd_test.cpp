// SPDX-License-Identifier: GPL-2.0-or-later
/// The few operations on packs that the compiler does not give: sums over lanes, ends of rows.
#include "lbm_solver/base/simd.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <type_traits>
#include <utility>
#include <vector>

namespace {

using namespace lbm;

/// A pack whose lanes are 1/3, 4/3 … times a factor: sums of them are rounded.
Pack numbers(double factor) {
  return Pack([factor](auto lane) { return factor * (static_cast<double>(lane) + 1.0 / 3.0); });
}

double sum(const Pack& pack) {
  double all = 0.0;
  for (int lane = 0; lane < kPackWidth; ++lane) all += pack[lane];
  return all;
}

template <class... Packs>
void expect_sums(const Packs&... packs) {
  constexpr std::size_t n = sizeof...(Packs);
  std::array<double, 9> to;
  to.fill(-7.0);
  store_sums(to.data(), packs...);
  const double exact[] = {sum(packs)...};
  for (std::size_t i = 0; i < n; ++i)  // another order of the same sum
    EXPECT_NEAR(to[i], exact[i], 1e-14 * std::abs(exact[i])) << i << " of " << n;
  for (std::size_t i = n; i < to.size(); ++i) EXPECT_EQ(to[i], -7.0) << i << " of " << n;
}

TEST(Packs, StoreSumsAddsTheLanesOfEachAndWritesNothingElse) {
  const Pack a = numbers(1.0), b = numbers(-20.0), c = numbers(1e6), d = numbers(1e-9);
  expect_sums(a);
  expect_sums(a, b);
  expect_sums(a, b, c);
  expect_sums(a, b, c, d);
  expect_sums(a, b, c, d, Pack(0.5));
  expect_sums(d, c, b, a, b, c);
  expect_sums(d, c, b, a, b, c, d);
  expect_sums(d, c, b, a, b, c, d, a);
}

/// Loads and stores `count` of the lanes; what lies beyond must be neither read nor written.
template <class V, class Real>
void expect_first_lanes() {
  constexpr int width = std::remove_cvref_t<decltype(lanes_of(std::declval<V&>()))>::size();
  for (int count = 0; count <= width; ++count) {
    // one of the lanes beyond would spread if it were read
    std::vector<Real> from(width, std::numeric_limits<Real>::quiet_NaN()), to(width, Real(-7)),
        loaded(width);
    for (int i = 0; i < count; ++i) from[i] = Real(i) + Real(0.5);
    const FirstLanes<V> first(count);
    const V v = first.load(from.data());
    AllLanes<V>().store(loaded.data(), v);
    first.store(to.data(), v + V(1.0));
    for (int i = 0; i < width; ++i) {
      EXPECT_EQ(loaded[i], i < count ? Real(i) + Real(0.5) : Real(0)) << i << " of " << count;
      EXPECT_EQ(to[i], i < count ? Real(i) + Real(1.5) : Real(-7)) << i << " of " << count;
    }
  }
}

TEST(Packs, FirstLanesReadAndWriteNothingBeyond) {
  expect_first_lanes<Pack, double>();
  expect_first_lanes<Pack, float>();
  expect_first_lanes<SinglePack, float>();
}

TEST(Packs, TwoOfDoublesAreOneOfFloatsAndBack) {
  const Pack low([](auto lane) { return lane + 0.25; });
  const Pack high([](auto lane) { return -16.0 * lane; });
  const SinglePack both = JoinedPacks::join(low, high);
  for (int lane = 0; lane < kPackWidth; ++lane) {
    EXPECT_EQ(both.lanes()[lane], lane + 0.25f);
    EXPECT_EQ(both.lanes()[kPackWidth + lane], -16.0f * static_cast<float>(lane));
    EXPECT_EQ(JoinedPacks::low(both)[lane], low[lane]);
    EXPECT_EQ(JoinedPacks::high(both)[lane], high[lane]);
  }
}

/// Each lane has one of four numbers by what it holds, whose fraction is cut off.
template <class V>
void expect_choice() {
  constexpr int width = std::remove_cvref_t<decltype(lanes_of(std::declval<V&>()))>::size();
  using Number = typename V::value_type;
  const LaneChoice choice(0.5, 1.5, 2.5, 3.5);
  std::vector<Number> by(width), chosen(width);
  for (int i = 0; i < width; ++i) by[i] = Number(i % 4) + Number(i % 2) * Number(0.5);
  const V which = AllLanes<V>().load(by.data());
  AllLanes<V>().store(chosen.data(), choice(LaneChoice::which(which)));
  for (int i = 0; i < width; ++i) EXPECT_EQ(chosen[i], Number(i % 4) + Number(0.5)) << i;
}

TEST(Packs, EachLaneChoosesOneOfFourNumbers) {
  expect_choice<Pack>();
  expect_choice<SinglePack>();
}

}  // namespace
