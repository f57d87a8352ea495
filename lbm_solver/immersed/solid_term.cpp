// SPDX-License-Identifier: GPL-2.0-or-later
#include "lbm_solver/immersed/solid_term.h"

#include <stdexcept>

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

}  // namespace

CoveredCollision::Factors CoveredCollision::factors(const SolidTerm& term,
                                                    SolidTerm::Parts SolidTerm::Halves::*half,
                                                    const SolidTerm::Parts& own) {
  const SolidTerm::Parts &surface = term.surface.*half, &whole = term.whole.*half,
                         &core = term.core.*half;
  // f + Ω^s has one f more than Ω^s; halves are of sums and differences.
  const double kept = own.f - 1.0;
  return {
      {0.5 * own.f, {0.5 * (surface.f - kept), 0.5 * (whole.f - kept), 0.5 * (core.f - kept)}},
      {own.fluid, {surface.fluid - own.fluid, whole.fluid - own.fluid, core.fluid - own.fluid}},
      {own.solid, {surface.solid - own.solid, whole.solid - own.solid, core.solid - own.solid}}};
}

SolidTerm solid_term(const std::string& name, double tau) {
  if (name == "noble_torczynski") return {kNobleTorczynski, kNobleTorczynski, kNobleTorczynski};
  if (name == "holdych") return {kHoldych, kHoldych, kHoldych};
  if (name == "superposition") return {superposition(tau), superposition(tau), superposition(tau)};
  // Nearly as accurate as the term of their surface (only the first whole cells shape the flow
  // outside), but a whole cell takes the solid's velocity in one step, so that the force contains
  // exactly the inertia of the fluid inside, which the coupling gives back exactly; and the core
  // forgets, so that nothing rings there.
  if (name == "layered_holdych") return {kHoldych, kBelowSurface, kEquilibrium};
  if (name == "layered_noble_torczynski") return {kNobleTorczynski, kBelowSurface, kEquilibrium};
  std::string known;
  for (const std::string& n : known_solid_terms()) known += " " + n;
  throw std::invalid_argument("no solid term '" + name + "'; known:" + known);
}

std::vector<std::string> known_solid_terms() {
  return {"noble_torczynski", "holdych", "superposition", "layered_holdych",
          "layered_noble_torczynski"};
}

}  // namespace lbm
