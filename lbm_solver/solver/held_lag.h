// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <complex>

namespace lbm {

/// A box between an opening whose flow PressureControl holds and the opposite one, lattice units.
struct HeldChannel {
  int length = 1;          ///< cells between the openings
  double gap = 0.0;        ///< cells between walls along it; 0: there are none
  double viscosity = 0.0;  ///< of the fluid
  bool outflow = false;    ///< the opposite opening is one; else it has a pressure
};

/// What comes of a flow cos(ωt) that PressureControl is to hold: amplitude and phase, by the
/// balance of the first harmonic of its two equations,
///   p = I + Z e,   iωT I = (Z + |I|) e,   e = 1 - u,   u = p/Z_in,
/// |I| e being nonlinear: of I cos θ times e it is (2/π) |I| (e + e* (I/|I|)²/3). Z_in is that of a
/// plane channel that takes up sound [Womersley1955]: with z = iω/(1 - tanh(λ)/λ) a cell, λ = ½ gap
/// √(iω/nu), and the fluid's compliance 3 iω it is √(z/3iω) tanh(L √(3iω z)) before a pressure. It
/// is within 0.03 of the flow that comes before a pressure, 0.11 before an outflow,
/// 0.08 about a mean flow (docs/boundaries.md). Solids in the box resist more: less of the flow
/// comes.
/// @param period  [steps]
std::complex<double> held_part(const HeldChannel& channel, double period);

}  // namespace lbm
