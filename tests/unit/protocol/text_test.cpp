// SPDX-License-Identifier: GPL-2.0-or-later
#include "protocol/wire/text.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include "protocol/wire/names.h"

namespace {

/// Numbers of all sizes, and those at which the form changes.
std::vector<double> numbers() {
  constexpr double huge = std::numeric_limits<double>::max();
  std::vector<double> all{0.0,
                          -0.0,
                          1.0,
                          -1.5,
                          0.1,
                          1e-4,
                          9.999e-5,
                          1e15,
                          1e16,
                          1e17,
                          1e5,
                          1e-5,
                          1e300,
                          12345.678,
                          huge,
                          -huge,
                          std::numeric_limits<double>::denorm_min(),
                          INFINITY,
                          -INFINITY};
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> mantissa(-10.0, 10.0), exponent(-300.0, 300.0);
  for (int n = 0; n < 1000; ++n) all.push_back(mantissa(random) * std::pow(10.0, exponent(random)));
  return all;
}

TEST(Text, WritesNumbersAsTheFormattingLibraryDoes) {
  for (const double x : numbers()) {
    EXPECT_EQ(protocol::format("{}", x), fmt::format("{}", x));
    EXPECT_EQ(protocol::format("{:.3g} and {:.9g}", x, -x),
              fmt::format("{:.3g} and {:.9g}", x, -x));
  }
  EXPECT_EQ(protocol::format("{} {:x}", std::int64_t{-7}, std::uint64_t{48879}), "-7 beef");
}

TEST(Text, PutsEachArgumentInItsField) {
  EXPECT_EQ(protocol::format("no field"), "no field");
  EXPECT_EQ(protocol::format("{}{}", 'x', std::string("yz")), "xyz");
  EXPECT_EQ(protocol::format("a {} b {} c", "{}", 2), "a {} b 2 c");
  EXPECT_EQ(protocol::join(std::vector<int>{1, 2, 3}, ", "), "1, 2, 3");
  EXPECT_EQ(protocol::join(std::vector<std::string>{}, ", "), "");
}

// LIGGGHTS' bodies lie below -1: of fix multisphere by their number, of each fix rigid apart.
TEST(Names, TellClumpsFromParticles) {
  EXPECT_EQ(protocol::name_of(7), "particle 7");
  EXPECT_EQ(protocol::name_of(7, true), "clump 7");
  EXPECT_EQ(protocol::name_of(-3), "clump 2");
  EXPECT_EQ(protocol::name_of(-4294967298), "clump 1 of the 1. fix rigid");
  EXPECT_EQ(protocol::name_of(protocol::clump_id(3, 12)), "clump 12 of the 3. fix rigid");
  EXPECT_EQ(protocol::name_of(protocol::Shape{.id = 5, .carrier = protocol::clump_id(0, 2)}),
            "particle 5 (of clump 2)");
  EXPECT_EQ(protocol::name_of(protocol::Shape{.id = 5}), "particle 5");
}

}  // namespace
