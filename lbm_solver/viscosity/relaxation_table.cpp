// SPDX-License-Identifier: GPL-2.0-or-later
#include "lbm_solver/viscosity/relaxation_table.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace lbm {
namespace {

constexpr double kSlowest = 1e-12, kFastest = 1.0;  // shear rates, lattice units: rest, and all
constexpr double kConstant = 1e-5;                  // change of tau that is none

/// Shear rate at which γ̇ tau(γ̇) = product, by halving its logarithm.
double shear_rate_of(const std::function<double(double)>& tau, double product) {
  double low = std::log(kSlowest) - 5.0, high = std::log(kFastest) + 5.0;
  for (int k = 0; k < 60; ++k) {
    const double middle = 0.5 * (low + high), rate = std::exp(middle);
    (rate * tau(rate) < product ? low : high) = middle;
  }
  return std::exp(0.5 * (low + high));
}

void check_growing(const std::function<double(double)>& tau) {
  double before = 0.0;
  for (double rate = kSlowest; rate <= kFastest; rate *= 1.1) {
    const double stress = rate * (tau(rate) - 0.5);
    if (!(stress > 0.0 && std::isfinite(stress)))
      throw std::invalid_argument(
          fmt::format("no positive viscosity at a shear rate of {:.3g} a step", rate));
    if (stress < before * (1.0 - 1e-9))
      throw std::invalid_argument(
          fmt::format("the stress falls with the shear rate at {:.3g} a step", rate));
    before = stress;
  }
}

std::int64_t piece_bits(double y) {
  return std::bit_cast<std::int64_t>(y) >> (52 - RelaxationTable::kBits);
}
double piece_begin(std::int64_t bits) {
  return std::bit_cast<double>(bits << (52 - RelaxationTable::kBits));
}

}  // namespace

RelaxationTable::RelaxationTable(const std::function<double(double)>& tau) {
  check_growing(tau);
  // where the law leaves the constant that it begins with, and where it reaches that of its end
  double slowest = kSlowest, fastest = kFastest;
  const auto differs = [&](double rate, double from) {
    return std::abs(tau(rate) / tau(from) - 1.0) > kConstant;
  };
  constexpr double apart = 1.01;
  while (slowest < kFastest / 4.0 && !differs(apart * slowest, 0.0)) slowest *= apart;
  while (fastest > 4.0 * slowest && !differs(fastest / apart, kFastest)) fastest /= apart;
  const auto y_of = [&](double rate) { return std::pow(2.0 / 3.0 * rate * tau(rate), 2.0); };
  first_ = piece_bits(y_of(slowest));
  last_ = piece_bits(y_of(fastest)) - first_ + 1;
  lowest_ = piece_begin(first_);
  highest_ = piece_begin(first_ + last_);
  double begin = lowest_, at_begin = 1.0 / tau(shear_rate_of(tau, 1.5 * std::sqrt(begin)));
  for (std::int64_t piece = 0; piece <= last_; ++piece) {
    const double end = piece_begin(first_ + piece + 1);
    const double at_end = 1.0 / tau(shear_rate_of(tau, 1.5 * std::sqrt(end)));
    const bool outer = piece == 0 || piece == last_;  // serves all that lies beyond, too
    const double slope = outer ? 0.0 : (at_end - at_begin) / (end - begin);
    const double value = at_begin - slope * begin;
    pieces_.push_back({value, slope});
    singles_.push_back({static_cast<float>(value), static_cast<float>(slope)});
    begin = end;
    at_begin = at_end;
  }
}

}  // namespace lbm
