// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include "lbm_solver/solver/plan.h"

namespace lbm {

/// Tables of a scene that do not reach over the time or the side that they are given for: beyond
/// its ends a table keeps its last value, which is seldom meant where it was not written. And those
/// that look as if they were in another unit, or stand beside a frequency.
/// @throws InputError  a profile lies wholly beyond its side, a period has too few steps
void check_tables(const Scene& scene, Plan& plan);

}  // namespace lbm
