// SPDX-License-Identifier: GPL-2.0-or-later
#include "lbm_solver/immersed/body_scheme.h"

#include <stdexcept>

#include "lbm_solver/immersed/linked_bodies.h"
#include "lbm_solver/immersed/marked_bodies.h"

namespace lbm {

std::unique_ptr<BodyScheme> make_scheme(const std::string& name, const Domain& domain,
                                        const Lattice& lattice, double spring_stiffness) {
  if (name == "bounce_back")
    return std::make_unique<LinkedBodies>(domain, lattice, WallPlace::HalfWay);
  if (name == "interpolated_bounce_back")
    return std::make_unique<LinkedBodies>(domain, lattice, WallPlace::Interpolated);
  if (name == "implicit_immersed_boundary") return std::make_unique<ImplicitMarkers>(domain);
  if (name == "spring_immersed_boundary")
    return std::make_unique<SpringMarkers>(domain, spring_stiffness);
  std::string known;
  for (const std::string& n : known_schemes()) known += " " + n;
  throw std::invalid_argument("no scheme '" + name + "'; known:" + known);
}

std::vector<std::string> known_schemes() {
  return {"immersed_moving_boundary", "bounce_back", "interpolated_bounce_back",
          "implicit_immersed_boundary", "spring_immersed_boundary"};
}

}  // namespace lbm
