// SPDX-License-Identifier: GPL-2.0-or-later
/// The table that a viscosity law is looked up in.
#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <limits>
#include <set>

#include "lbm_solver/viscosity/mean_law.h"
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

// γ̇ ∝ σ^m, m = 1/n, of which the mean is ((1+a)^(m+1) - (1-a)^(m+1))/(2 a (m+1)) times that of the
// middle; places 2 % apart, straight between, are off by some 1e-4.
TEST(MeanLaw, OfAPowerLawIsTheIntegral) {
  for (const double n : {0.3, 1.0, 1.5})
    for (const double a : {0.05, 0.2}) {
      const auto nu = [n](double rate) { return 1e-2 * std::pow(rate, n - 1.0); };
      const MeanLaw mean([&](double rate) { return 0.5 + nu(rate); }, a);
      const double m = 1.0 / n, factor = (std::pow(1.0 + a, m + 1.0) - std::pow(1.0 - a, m + 1.0)) /
                                         (2.0 * a * (m + 1.0));
      for (const double rate : {1e-7, 1e-3, 0.1})
        EXPECT_NEAR((mean(factor * rate) - 0.5) / (nu(rate) / factor), 1.0, 5e-4) << n << ' ' << a;
    }
}

// Where the largest of the stresses reaches the yield stress, within the 2 % between places; above
// the smallest one the mean is that of the middle.
TEST(MeanLaw, OfABinghamFluidYieldsWhereTheLargestStressDoes) {
  constexpr double yield = 1e-5, plastic = 1e-2, stiff = 50.0, a = 0.1;
  const MeanLaw mean(
      [](double rate) { return 0.5 + std::min(plastic + yield / rate, double{stiff}); }, a);
  const auto rate_at = [](double stress) {
    return std::max(stress / stiff, (stress - yield) / plastic);
  };
  const double below = 0.97 * yield / (1.0 + a), above = 1.02 * yield / (1.0 - a);
  EXPECT_NEAR(mean(below / stiff) - 0.5, stiff, 1e-3 * stiff);
  EXPECT_NEAR((mean(rate_at(above)) - 0.5) * rate_at(above) / above, 1.0, 1e-3);
  // at σ_y half of them have yielded: γ̄ = a σ_y/(4 plastic), and the creep of the other half
  const double middle = 0.25 * a * yield / plastic;
  EXPECT_NEAR((mean(middle) - 0.5) * middle / yield, 1.0, 1e-2);
}

}  // namespace
