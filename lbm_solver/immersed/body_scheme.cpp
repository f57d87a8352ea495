// SPDX-License-Identifier: GPL-2.0-or-later
#include "lbm_solver/immersed/body_scheme.h"

#include <stdexcept>

#include "lbm_solver/immersed/linked_bodies.h"
#include "lbm_solver/immersed/marked_bodies.h"

namespace lbm {

std::unique_ptr<BodyScheme> make_scheme(SolidScheme scheme, const Domain& domain,
                                        const Lattice& lattice, double spring_stiffness) {
  switch (scheme) {
    case SolidScheme::BounceBack:
      return std::make_unique<LinkedBodies>(domain, lattice, WallPlace::HalfWay);
    case SolidScheme::InterpolatedBounceBack:
      return std::make_unique<LinkedBodies>(domain, lattice, WallPlace::Interpolated);
    case SolidScheme::ImplicitImmersedBoundary:
      return std::make_unique<ImplicitMarkers>(domain);
    case SolidScheme::SpringImmersedBoundary:
      return std::make_unique<SpringMarkers>(domain, spring_stiffness);
    case SolidScheme::ImmersedMovingBoundary:
      break;
  }
  throw std::invalid_argument("scheme '" + name_of(scheme) + "' is part of the sweep");
}

}  // namespace lbm
