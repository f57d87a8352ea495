// SPDX-License-Identifier: GPL-2.0-or-later
#include "lbm_solver/viscosity/mean_law.h"

#include <algorithm>
#include <cmath>

namespace lbm {
namespace {

constexpr double kSlowest = 1e-16, kFastest = 1e3, kApart = 1.02;  // shear rates that are looked at

/// ∫ γ̇ dσ from rest, straight between known places.
class Integral {
 public:
  Integral(std::vector<double> stresses, std::vector<double> rates)
      : stresses_(std::move(stresses)), rates_(std::move(rates)) {
    sums_.push_back(0.5 * stresses_[0] * rates_[0]);
    for (std::size_t i = 1; i < rates_.size(); ++i)
      sums_.push_back(sums_.back() +
                      0.5 * (stresses_[i] - stresses_[i - 1]) * (rates_[i] + rates_[i - 1]));
  }
  double operator()(double stress) const {
    const auto next = std::ranges::upper_bound(stresses_, stress) - stresses_.begin();
    if (next == 0) return sums_[0] * std::pow(stress / stresses_[0], 2);
    const auto i = std::min<std::size_t>(next, rates_.size() - 1);
    const double slope = (rates_[i] - rates_[i - 1]) / (stresses_[i] - stresses_[i - 1]);
    const double beyond = stress - stresses_[i - 1];
    return sums_[i - 1] + beyond * (rates_[i - 1] + 0.5 * slope * beyond);
  }

 private:
  std::vector<double> stresses_, rates_, sums_;
};

}  // namespace

MeanLaw::MeanLaw(const std::function<double(double)>& tau, double spread) {
  std::vector<double> stresses, rates;
  for (double rate = kSlowest; rate < kFastest; rate *= kApart) {
    const double stress = rate * (tau(rate) - 0.5);
    if (!stresses.empty() && !(stress > stresses.back())) continue;
    stresses.push_back(stress);
    rates.push_back(rate);
  }
  const Integral integral(stresses, rates);
  for (const double stress : stresses) {
    const double mean = (integral(stress * (1.0 + spread)) - integral(stress * (1.0 - spread))) /
                        (2.0 * spread * stress);
    stresses_.push_back(std::log(stress));
    rates_.push_back(std::log(mean));
  }
}

double MeanLaw::operator()(double shear_rate) const {
  const double rate = std::log(std::max(shear_rate, kSlowest));
  const auto next = std::ranges::upper_bound(rates_, rate) - rates_.begin();
  const auto i = std::clamp<std::size_t>(next, 1, rates_.size() - 1);
  const double part = (rate - rates_[i - 1]) / (rates_[i] - rates_[i - 1]);
  return 0.5 + std::exp(stresses_[i - 1] + part * (stresses_[i] - stresses_[i - 1]) - rate);
}

}  // namespace lbm
