// SPDX-License-Identifier: GPL-2.0-or-later
/// Boundaries of a fluid in two dimensions, for tests.
#pragma once

#include "lbm_solver/solver/fluid.h"

namespace test {

/// Cells [begin, end) of a side, with ends.
inline lbm::Opening part(lbm::SideName side, int begin, int end) {
  return {side, {begin, 0}, {end, 1}, {false, true}};
}

inline void add_velocity(lbm::Fluid& fluid, const lbm::Opening& opening, const lbm::Vec3& u,
                         bool parabolic = false, const lbm::InTime& in_time = {}) {
  fluid.add(std::make_unique<lbm::VelocityPatch>(fluid.lattice(), fluid.links(opening), u,
                                                 parabolic, opening, in_time));
}

inline void add_pressure(lbm::Fluid& fluid, const lbm::Opening& opening, double drho,
                         const lbm::InTime& in_time = {}) {
  fluid.add(
      std::make_unique<lbm::PressurePatch>(fluid.links(opening), opening.side, drho, in_time));
}

inline void add_outflow(lbm::Fluid& fluid, const lbm::Opening& opening, double drho, double relax) {
  fluid.add(std::make_unique<lbm::OutflowPatch>(fluid.links(opening), opening.side, drho, relax));
}

}  // namespace test
