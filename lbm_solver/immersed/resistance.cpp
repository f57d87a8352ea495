// SPDX-License-Identifier: GPL-2.0-or-later
#include "lbm_solver/immersed/resistance.h"

#include "lbm_solver/immersed/radius_shift.h"

namespace lbm {

ResistanceCollision::ResistanceCollision(SolidTerm term, const CollisionParameters& parameters)
    : tau_(parameters.tau), rate_(1.0 / tau_), mu_zero_(2.0 - 16.0 / 3.0 * parameters.magic) {
  const SolidTermRows rows = solid_term_rows(term, parameters.tau);
  const auto choice = [&](auto&& of) {
    return LaneChoice(of(rows.surface), of(rows.whole), of(rows.core), of(rows.wall));
  };
  momentum_ = choice([](const SolidTermRows::Halves& h) { return h.odd.solid; });
  ghost_ = choice([](const SolidTermRows::Halves& h) { return -h.odd.f; });
  even_ = choice([](const SolidTermRows::Halves& h) { return -h.even.f; });
  even_at_fluid_ = choice([](const SolidTermRows::Halves& h) { return h.even.fluid; });
  even_at_solid_ = choice([](const SolidTermRows::Halves& h) { return h.even.solid; });
}

RadiusShift radius_shift(SolidTerm solid_term, int dimension) {
  if (!by_resistance(solid_term)) return {};
  return dimension == 2 ? RadiusShift{-0.02, 0.13} : RadiusShift{-0.005, 0.16};
}

double load_lag(SolidTerm solid_term, double tau) {
  if (!by_resistance(solid_term)) return 0.0;
  const double momentum =
      solid_term == SolidTerm::Resistance ? 2.0 : ShellExchange(tau - 0.5).momentum;
  return (momentum - 1.0) / momentum;
}

}  // namespace lbm
