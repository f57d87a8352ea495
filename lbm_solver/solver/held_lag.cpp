// SPDX-License-Identifier: GPL-2.0-or-later
#include "lbm_solver/solver/held_lag.h"

#include <cmath>
#include <numbers>

#include "lbm_solver/solver/pressure_control.h"

namespace lbm {
namespace {

using Complex = std::complex<double>;

constexpr int kRounds = 500;  // of the iteration for |I|; each halves what is left, or better

/// Pressure over velocity at the opening.
Complex impedance(const HeldChannel& channel, double w) {
  const Complex iw(0.0, w);
  Complex a_cell = iw;
  if (channel.gap > 0.0) {
    const Complex half = 0.5 * channel.gap * std::sqrt(iw / channel.viscosity);
    a_cell /= 1.0 - std::tanh(half) / half;
  }
  const Complex compliance = 3.0 * iw, line = std::sqrt(a_cell / compliance),
                t = std::tanh(static_cast<double>(channel.length) * std::sqrt(a_cell * compliance));
  // an outflow lets sound out, and draws its pressure to the target in a crossing of the box
  const double drawn = PressureControl::kSound / channel.length;
  const Complex end = channel.outflow ? PressureControl::kSound * iw / (iw + drawn) : 0.0;
  return line * (end + line * t) / (line + end * t);
}

}  // namespace

std::complex<double> held_part(const HeldChannel& channel, double period) {
  constexpr double z = PressureControl::kImpedance;
  const double w = 2.0 * std::numbers::pi / period;
  // half of the time between two looks until the flow is measured, and as long until p acts
  const Complex late = std::polar(1.0, -w * static_cast<double>(PressureControl::kEvery));
  const Complex iwt(0.0, w * PressureControl::time(channel.length)),
      load = late / impedance(channel, w), a = 1.0 / (1.0 + z * load), b = load * a;
  Complex integral(z, 0.0);
  for (int round = 0; round < kRounds; ++round) {
    const double size = std::abs(integral);
    if (size == 0.0) break;
    const Complex turn = integral / size, e = a - b * integral;
    const Complex c = (z + 2.0 / std::numbers::pi * size) / iwt,
                  other = 2.0 / (3.0 * std::numbers::pi) * size * std::conj(e) * turn * turn / iwt;
    integral = 0.5 * (integral + (c * a + other) / (1.0 + c * b));
  }
  return 1.0 - (a - b * integral);
}

}  // namespace lbm
