// SPDX-License-Identifier: GPL-2.0-or-later
#include "lbm_solver/immersed/solid_term.h"

#include <stdexcept>

#include "lbm_solver/immersed/resistance.h"

namespace lbm {
namespace {

/// [NobleTorczynski1998], paper A Eq 35:  Ω_i^s = f_-i - f_i + f_i^eq(rho,u_s) - f_-i^eq(rho,u)
constexpr SolidTerm::Halves kNobleTorczynski{{0.0, -1.0, 1.0}, {-2.0, 1.0, 1.0}};

/// [Holdych2003], paper A Eq 39:  Ω_i^s = f_-i - f_i + f_i^eq(rho,u_s) - f_-i^eq(rho,u_s)
/// In a whole cell this is full bounce-back: trapped fluid overshoots u_s and rings with period
/// two, which throws a freely moving light particle out of the box within some ten steps and
/// blows up in a spinning body.
constexpr SolidTerm::Halves kHoldych{{0.0, 0.0, 0.0}, {-2.0, 0.0, 2.0}};

/// Forgets what was there:  Ω_i^s = f_i^eq(rho,u_s) - f_i
constexpr SolidTerm::Halves kEquilibrium{{-1.0, 0.0, 1.0}, {-1.0, 0.0, 1.0}};

/// Superposition:  Ω_i^s = f_i^eq(rho,u_s) - f_i + (1 - 1/τ)(f_i - f_i^eq(rho,u))
constexpr SolidTerm::Halves superposition(double tau) {
  const double kept = 1.0 - 1.0 / tau;
  return {{kept - 1.0, -kept, 1.0}, {kept - 1.0, -kept, 1.0}};
}

/// Below the surface of a layered term: Noble–Torczynski, which turns or keeps all of the
/// non-equilibrium part of trapped populations, for ever; in a spinning body that grows by about
/// e in 1000 steps. A twentieth of the equilibrium ends it, and costs little accuracy.
constexpr SolidTerm::Parts mix(const SolidTerm::Parts& a, const SolidTerm::Parts& b, double part) {
  return {a.f + part * (b.f - a.f), a.fluid + part * (b.fluid - a.fluid),
          a.solid + part * (b.solid - a.solid)};
}
constexpr double kForget = 0.05;
constexpr SolidTerm::Halves kBelowSurface{mix(kNobleTorczynski.even, kEquilibrium.even, kForget),
                                          mix(kNobleTorczynski.odd, kEquilibrium.odd, kForget)};

/// The same by resistance: all but reflection, see ShellExchange.
SolidTerm::Halves shell(double tau) {
  const ShellExchange e(tau - 0.5);
  return {{-e.even_rate, 0.0, e.even_rate}, {-2.0, 2.0 - e.momentum, e.momentum}};
}

}  // namespace

CoveredCollision::Factors CoveredCollision::factors(const SolidTerm& term,
                                                    SolidTerm::Parts SolidTerm::Halves::*half,
                                                    const SolidTerm::Parts& own) {
  const SolidTerm::Parts &surface = term.surface.*half, &whole = term.whole.*half,
                         &core = term.core.*half, &wall = term.wall.*half;
  // f + Ω^s has one f more than Ω^s; halves are of sums and differences.
  const double kept = own.f - 1.0;
  const auto choice = [&](double part, double SolidTerm::Parts::*of, double scale) {
    return LaneChoice(scale * (surface.*of - part), scale * (whole.*of - part),
                      scale * (core.*of - part), scale * (wall.*of - part));
  };
  return {{0.5 * own.f, choice(kept, &SolidTerm::Parts::f, 0.5)},
          {own.fluid, choice(own.fluid, &SolidTerm::Parts::fluid, 1.0)},
          {own.solid, choice(own.solid, &SolidTerm::Parts::solid, 1.0)}};
}

SolidTerm solid_term(const std::string& name, double tau) {
  const auto same = [](const SolidTerm::Halves& h) { return SolidTerm{h, h, h, kHoldych}; };
  const auto layered = [](const SolidTerm::Halves& surface) {
    return SolidTerm{surface, kBelowSurface, kEquilibrium, kHoldych};
  };
  if (name == "noble_torczynski") return same(kNobleTorczynski);
  if (name == "holdych") return same(kHoldych);
  if (name == "superposition") return same(superposition(tau));
  // Nearly as accurate as the term of their surface (only the first whole cells shape the flow
  // outside), but a whole cell takes the solid's velocity in one step, so that the force contains
  // exactly the inertia of the fluid inside, which the coupling gives back exactly; and the core
  // forgets, so that nothing rings there.
  if (name == "layered_holdych") return layered(kHoldych);
  if (name == "layered_noble_torczynski") return layered(kNobleTorczynski);
  if (name == "resistance") return same(kHoldych);
  if (name == "layered_resistance") return {kHoldych, shell(tau), kEquilibrium, kHoldych};
  std::string known;
  for (const std::string& n : known_solid_terms()) known += " " + n;
  throw std::invalid_argument("no solid term '" + name + "'; known:" + known);
}

bool by_resistance(const std::string& name) {
  return name == "resistance" || name == "layered_resistance";
}

std::vector<std::string> known_solid_terms() {
  return {"resistance",    "layered_resistance", "noble_torczynski",        "holdych",
          "superposition", "layered_holdych",    "layered_noble_torczynski"};
}

}  // namespace lbm
