// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <string>
#include <vector>

#include "lbm_solver/solver/plan.h"

namespace lbm {

/// Tables of a scene that do not reach over the time or the side that they are given for: beyond
/// its ends a table keeps its last value, which is seldom meant where it was not written. And those
/// that look as if they were in another unit, or stand beside a frequency.
/// @throws InputError  a profile lies wholly beyond its side, a period has too few steps
void check_tables(const Scene& scene, Plan& plan);

/// Where times of a table and the run's do not meet: all of it lies before or behind the run, most
/// of it behind its end, or all of it in its first moment. Empty where they do.
/// @param times    rising [s], at least two
/// @param repeats  the last is the first of the next period
std::string odd_times(const std::vector<double>& times, bool repeats, double end_time);

}  // namespace lbm
