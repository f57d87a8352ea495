// SPDX-License-Identifier: GPL-2.0-or-later
#include "lbm_solver/immersed/solid_term.h"

#include <stdexcept>

namespace lbm {
namespace {

/// [NobleTorczynski1998], paper A Eq 35:  Ω_i^s = f_-i - f_i + f_i^eq(rho,u_s) - f_-i^eq(rho,u)
constexpr SolidTerm::Halves kNobleTorczynski{{0.0, -1.0, 1.0}, {-2.0, 1.0, 1.0}};

/// [Holdych2003], paper A Eq 39:  Ω_i^s = f_-i - f_i + f_i^eq(rho,u_s) - f_-i^eq(rho,u_s)
/// In a whole cell this is full bounce-back: trapped fluid overshoots u_s and rings with period
/// two, which throws a freely moving light particle out of the box within some ten steps.
constexpr SolidTerm::Halves kHoldych{{0.0, 0.0, 0.0}, {-2.0, 0.0, 2.0}};

/// Forgets what was there:  Ω_i^s = f_i^eq(rho,u_s) - f_i
constexpr SolidTerm::Halves kEquilibrium{{-1.0, 0.0, 1.0}, {-1.0, 0.0, 1.0}};

/// Superposition:  Ω_i^s = f_i^eq(rho,u_s) - f_i + (1 - 1/τ)(f_i - f_i^eq(rho,u))
constexpr SolidTerm::Halves superposition(double tau) {
  const double kept = 1.0 - 1.0 / tau;
  return {{kept - 1.0, -kept, 1.0}, {kept - 1.0, -kept, 1.0}};
}

}  // namespace

SolidTerm solid_term(const std::string& name, double tau) {
  if (name == "noble_torczynski") return {kNobleTorczynski, kNobleTorczynski, kNobleTorczynski};
  if (name == "holdych") return {kHoldych, kHoldych, kHoldych};
  if (name == "superposition") return {superposition(tau), superposition(tau), superposition(tau)};
  // As accurate as Holdych (only the first whole cells shape the flow outside), but a whole cell
  // takes the solid's velocity in one step, so that the force contains exactly the inertia of the
  // fluid inside, which the coupling gives back exactly; and the core forgets, so that nothing
  // rings there.
  if (name == "layered_holdych") return {kHoldych, kNobleTorczynski, kEquilibrium};
  std::string known;
  for (const std::string& n : known_solid_terms()) known += " " + n;
  throw std::invalid_argument("no solid term '" + name + "'; known:" + known);
}

std::vector<std::string> known_solid_terms() {
  return {"noble_torczynski", "holdych", "superposition", "layered_holdych"};
}

}  // namespace lbm
