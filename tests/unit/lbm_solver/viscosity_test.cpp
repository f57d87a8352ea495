// SPDX-License-Identifier: GPL-2.0-or-later
/// The table that a viscosity law is looked up in.
#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <limits>
#include <set>

#include "lbm_solver/viscosity/relaxation_table.h"

namespace {

using namespace lbm;

double y_of(double shear_rate, double tau) {
  return std::pow(2.0 / 3.0 * shear_rate * tau, 2);
}

struct NamedLaw {
  const char* name;
  std::function<double(double)> nu;  // lattice units
};
const NamedLaw kLaws[] = {
    {"thinning", [](double g) { return std::clamp(1e-3 / std::sqrt(g), 1e-3, 10.0); }},
    {"n = 0.3", [](double g) { return std::clamp(1e-3 * std::pow(g, -0.7), 1e-3, 30.0); }},
    {"thickening", [](double g) { return std::clamp(20.0 * std::sqrt(g), 1e-3, 1.0); }},
    {"Bingham", [](double g) { return std::min(0.1 + 1e-5 / g, 50.0); }},
    {"Papanastasiou",
     [](double g) { return 0.1 - 1e-5 * std::expm1(-5e6 * (g + 1e-30)) / (g + 1e-30); }},
    {"constant", [](double) { return 0.2; }}};

// Straight pieces 1/32 of a doubling of Y long are off by (Y/32)²/8 |d²(1/τ)/dY²| where the law is
// smooth, 1e-4 of the largest rate. In a piece with a kink, where the law meets a bound or yields,
// they are off by up to a quarter of the slope's jump, (1/64)/4 of it.
TEST(RelaxationTable, GivesTheRateOfALawFromItsStress) {
  for (const NamedLaw& law : kLaws) {
    const auto tau = [&](double rate) { return 0.5 + 3.0 * law.nu(rate); };
    const RelaxationTable table(tau);
    EXPECT_LT(table.bytes(), 64 * 1024u) << law.name;
    const double largest = std::max(1.0 / tau(0.0), 1.0 / tau(1.0));
    std::set<std::int64_t> kinks;  // pieces
    for (double rate = 1e-11; rate < 0.5; rate *= 1.003) {
      const double y = y_of(rate, tau(rate)), error = std::abs(table(y) - 1.0 / tau(rate));
      if (error > 1.2e-4 * largest)
        kinks.insert(std::bit_cast<std::int64_t>(y) >> (52 - RelaxationTable::kBits));
      EXPECT_LT(error, 4e-3 * largest) << law.name << " at " << rate;
      EXPECT_NEAR(table.shear_rate(y) / rate, 1.0, 1.1 * error * tau(rate) + 1e-12) << law.name;
    }
    EXPECT_LE(kinks.size(), 3u) << law.name;
  }
}

TEST(RelaxationTable, IsTheSameInEveryLane) {
  const RelaxationTable table(
      [](double g) { return 0.5 + 3.0 * std::clamp(1e-3 / std::sqrt(g), 1e-3, 10.0); });
  for (double y = 1e-30; y < 1.0; y *= 1.7) {
    const Pack doubles([&](auto lane) { return y * (1.0 + 0.3 * static_cast<double>(lane)); });
    const Pack looked_up = table(doubles);
    for (int k = 0; k < kPackWidth; ++k)
      EXPECT_NEAR(looked_up[k], table(static_cast<double>(doubles[k])), 1e-15) << y;
    SinglePack::Lanes lanes;
    for (int k = 0; k < SinglePack::size(); ++k) lanes[k] = static_cast<float>(y * (1.0 + 0.3 * k));
    const SinglePack singles(lanes);
    const SinglePack floats = table(singles);
    for (int k = 0; k < SinglePack::size(); ++k) {
      const double exact = table(static_cast<double>(singles.lanes()[k]));
      EXPECT_NEAR(floats.lanes()[k] / exact, 1.0, 1e-6) << y;
    }
  }
}

TEST(RelaxationTable, RestIsTheBeginningAndWhatIsNoNumberStaysSo) {
  const RelaxationTable table(
      [](double g) { return 0.5 + 3.0 * std::clamp(1e-3 / std::sqrt(g), 1e-3, 10.0); });
  EXPECT_NEAR(table(0.0), 1.0 / 30.5, 1e-6);
  EXPECT_NEAR(table(1e300), 1.0 / 0.503, 1e-6);
  EXPECT_TRUE(std::isnan(table(std::numeric_limits<double>::quiet_NaN())));
  EXPECT_TRUE(
      std::isnan(static_cast<double>(table(Pack(std::numeric_limits<double>::quiet_NaN()))[0])));
}

TEST(RelaxationTable, RefusesAStressThatFalls) {
  EXPECT_THROW(RelaxationTable([](double g) { return 0.5 + 1e-6 / (g * g + 1e-20); }),
               std::invalid_argument);
  EXPECT_THROW(RelaxationTable([](double) { return 0.4; }), std::invalid_argument);
}

}  // namespace
