// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <string>

#include "lbm_solver/base/scene.h"

namespace lbm {

/// What a LIGGGHTS script writes behind `fix ID all move/mesh mesh MESH`, so that a mesh moves as
/// in the fluid; behind `fix ID all mesh/surface file …` for one whose surface only moves. Words
/// and numbers that are made here: nothing of the scene's text is in them.
/// @throws std::logic_error  a motion that LIGGGHTS does not know: see check_motions
std::string mesh_motion_words(const MotionScene& motion);

/// A disc that turns about its middle as a wall of a script in two dimensions, behind
/// `fix ID all wall/gran MODEL primitive type N`; empty where it is none.
/// @param grain_radius  of those that shall meet the wall at its own speed [m]
std::string disc_wall_words(const ObstacleScene& obstacle, double grain_radius);

}  // namespace lbm
