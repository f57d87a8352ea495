// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <map>
#include <string>

#include "lbm_solver/solver/plan.h"

namespace lbm {

/// Numbers of a scene and its plan by name, SI units, for the summary: what a reader needs to
/// interpret the results. What drives the fluid is there as far as it is steady.
std::map<std::string, double> scene_parameters(const Scene& scene, const Plan& plan);

}  // namespace lbm
