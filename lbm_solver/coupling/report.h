// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <string>

#include "lbm_solver/io/summary.h"
#include "lbm_solver/solver/plan.h"

namespace lbm {

/// Lattices, operators, solid terms and schemes that a scene may name.
std::string describe_choices();

/// The resolved scene and its unit table, for `lbm check` and the head of a log.
std::string describe(const Scene& scene, const Plan& plan);

/// What is on, what is off, memory, and the run time that a short measurement of this scene's
/// kernel on its own grid predicts. Allocates the lattice, exchanges nothing.
std::string describe_cost(const Scene& scene, const Plan& plan);

/// The end of a run in a few lines.
std::string describe(const Summary& summary);

}  // namespace lbm
