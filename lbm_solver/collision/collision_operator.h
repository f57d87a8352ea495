// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <iosfwd>
#include <string>
#include <vector>

namespace lbm {

/// How the populations of a fluid cell relax; lbm_solver/README.md says what each is good for.
enum class CollisionOperator { Bgk, Trt, CentralMoment, RecursiveRegularised };

/// All of them, in the order of the enumeration.
std::vector<CollisionOperator> known_collisions();

/// As a scene and a report write it: "bgk", "trt", "central_moment", "recursive_regularised".
std::string name_of(CollisionOperator collision);
/// @throws std::invalid_argument naming the known ones
CollisionOperator collision_operator(const std::string& name);

std::ostream& operator<<(std::ostream& out, CollisionOperator collision);

}  // namespace lbm
