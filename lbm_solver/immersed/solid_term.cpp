// SPDX-License-Identifier: GPL-2.0-or-later
#include "lbm_solver/immersed/solid_term.h"

#include <stdexcept>

#include "lbm_solver/immersed/resistance.h"

namespace lbm {
namespace {

/// [NobleTorczynski1998], paper A Eq 35:  Ω_i^s = f_-i - f_i + f_i^eq(rho,u_s) - f_-i^eq(rho,u)
constexpr SolidTermRows::Halves kNobleTorczynski{{0.0, -1.0, 1.0}, {-2.0, 1.0, 1.0}};

/// [Holdych2003], paper A Eq 39:  Ω_i^s = f_-i - f_i + f_i^eq(rho,u_s) - f_-i^eq(rho,u_s)
/// In a whole cell this is full bounce-back: trapped fluid overshoots u_s and rings with period
/// two, which throws a freely moving light particle out of the box within some ten steps and
/// blows up in a spinning body.
constexpr SolidTermRows::Halves kHoldych{{0.0, 0.0, 0.0}, {-2.0, 0.0, 2.0}};

/// Forgets what was there:  Ω_i^s = f_i^eq(rho,u_s) - f_i
constexpr SolidTermRows::Halves kEquilibrium{{-1.0, 0.0, 1.0}, {-1.0, 0.0, 1.0}};

/// Superposition:  Ω_i^s = f_i^eq(rho,u_s) - f_i + (1 - 1/τ)(f_i - f_i^eq(rho,u))
constexpr SolidTermRows::Halves superposition(double tau) {
  const double kept = 1.0 - 1.0 / tau;
  return {{kept - 1.0, -kept, 1.0}, {kept - 1.0, -kept, 1.0}};
}

/// Below the surface of a layered term: Noble–Torczynski, which turns or keeps all of the
/// non-equilibrium part of trapped populations, for ever; in a spinning body that grows by about
/// e in 1000 steps. A twentieth of the equilibrium ends it, and costs little accuracy.
constexpr SolidTermRows::Parts mix(const SolidTermRows::Parts& a, const SolidTermRows::Parts& b,
                                   double part) {
  return {a.f + part * (b.f - a.f), a.fluid + part * (b.fluid - a.fluid),
          a.solid + part * (b.solid - a.solid)};
}
constexpr double kForget = 0.05;
constexpr SolidTermRows::Halves kBelowSurface{
    mix(kNobleTorczynski.even, kEquilibrium.even, kForget),
    mix(kNobleTorczynski.odd, kEquilibrium.odd, kForget)};

/// The same by resistance: all but reflection, see ShellExchange.
SolidTermRows::Halves shell(double tau) {
  const ShellExchange e(tau - 0.5);
  return {{-e.even_rate, 0.0, e.even_rate}, {-2.0, 2.0 - e.momentum, e.momentum}};
}

}  // namespace

CoveredCollision::Factors CoveredCollision::factors(
    const SolidTermRows& rows, SolidTermRows::Parts SolidTermRows::Halves::*half,
    const SolidTermRows::Parts& own) {
  const SolidTermRows::Parts &surface = rows.surface.*half, &whole = rows.whole.*half,
                             &core = rows.core.*half, &wall = rows.wall.*half;
  // f + Ω^s has one f more than Ω^s; halves are of sums and differences.
  const double kept = own.f - 1.0;
  const auto choice = [&](double part, double SolidTermRows::Parts::*of, double scale) {
    return LaneChoice(scale * (surface.*of - part), scale * (whole.*of - part),
                      scale * (core.*of - part), scale * (wall.*of - part));
  };
  return {{0.5 * own.f, choice(kept, &SolidTermRows::Parts::f, 0.5)},
          {own.fluid, choice(own.fluid, &SolidTermRows::Parts::fluid, 1.0)},
          {own.solid, choice(own.solid, &SolidTermRows::Parts::solid, 1.0)}};
}

SolidTermRows solid_term_rows(SolidTerm term, double tau) {
  using Rows = SolidTermRows;
  const auto same = [](const Rows::Halves& h) { return Rows{h, h, h, kHoldych}; };
  // Nearly as accurate as the term of their surface (only the first whole cells shape the flow
  // outside), but a whole cell takes the solid's velocity in one step, so that the force contains
  // exactly the inertia of the fluid inside, which the coupling gives back exactly; and the core
  // forgets, so that nothing rings there.
  const auto layered = [](const Rows::Halves& surface) {
    return Rows{surface, kBelowSurface, kEquilibrium, kHoldych};
  };
  switch (term) {
    case SolidTerm::NobleTorczynski:
      return same(kNobleTorczynski);
    case SolidTerm::Holdych:
    case SolidTerm::Resistance:
      return same(kHoldych);
    case SolidTerm::Superposition:
      return same(superposition(tau));
    case SolidTerm::LayeredHoldych:
      return layered(kHoldych);
    case SolidTerm::LayeredNobleTorczynski:
      return layered(kNobleTorczynski);
    case SolidTerm::LayeredResistance:
      return {kHoldych, shell(tau), kEquilibrium, kHoldych};
    case SolidTerm::None:
      break;
  }
  throw std::invalid_argument("solid term 'none' has no rows");
}

bool by_resistance(SolidTerm term) {
  return term == SolidTerm::Resistance || term == SolidTerm::LayeredResistance;
}

}  // namespace lbm
