// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <string>

#include "lbm_solver/base/scene.h"

namespace lbm {

/// Refuses a scene whose parts do not fit together, whatever its step: particles and obstacles
/// outside the box or in each other, two boundaries on the same part of a side.
/// @throws InputError
void check_places(const Scene& scene);

/// Overlap over a diameter that rounding may make.
constexpr double kTouch = 1e-3;

/// A key of an obstacle, or where that is empty its table, with file and line, as a message begins.
std::string key_of(const Scene& scene, const ObstacleScene& obstacle, const std::string& key = {});

/// How far a ball of radius r [m] lies in an obstacle, over its diameter; not positive outside.
double depth_in(const Scene& scene, const ObstacleScene& obstacle, const Vec3& centre, double r);

/// Where a boundary lies along the k-th axis of its side [m].
Range extent(const Scene& scene, const BoundaryScene& boundary, int k);

/// A place as a message says it, with the dimensions of the scene.
std::string place_text(const Scene& scene, const Vec3& place);

}  // namespace lbm
