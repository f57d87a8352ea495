// SPDX-License-Identifier: GPL-2.0-or-later
#include "lbm_solver/solver/table_check.h"

#include <fmt/core.h>

#include <algorithm>
#include <vector>

#include "lbm_solver/base/errors.h"
#include "lbm_solver/solver/place_check.h"

namespace lbm {
namespace {

constexpr double kLittle = 0.5;  // of a boundary that a profile covers

/// A plateau at an end of a table says that the value shall stay, a 0 that nothing shall be there.
void check_times(const Scene& s, const TimeTableScene& table, const std::string& key, Plan& plan) {
  if (table.times.empty() || table.repeats) return;
  const std::vector<double>&times = table.times, &factors = table.factors;
  const std::size_t n = times.size();
  if (times.front() > 0.0 && factors[0] != factors[1] && factors[0] != 0.0)
    plan.warnings.push_back(
        fmt::format("{} begins at {:.4g} s: until then it has its first factor, {:.4g}; add a line "
                    "at 0 s",
                    key, times.front(), factors.front()));
  if (times.back() < s.end_time * (1.0 - 1e-9) && factors[n - 1] != factors[n - 2] &&
      factors[n - 1] != 0.0)
    plan.warnings.push_back(
        fmt::format("{} ends at {:.4g} s, the run at {:.4g} s: from then on it keeps its last "
                    "factor, {:.4g}; add a line at the run's end",
                    key, times.back(), s.end_time, factors.back()));
}

void check_profile(const Scene& s, const BoundaryScene& b, std::size_t number, Plan& plan) {
  for (int k = 0; k < s.box.dimension - 1; ++k) {
    const std::vector<double>& places = b.profile.places[k];
    if (places.empty()) continue;
    const Range side = extent(s, b, k);
    const char axis = "xyz"[axis_along(b.side, k)];
    const std::string what = fmt::format(
        "has places from {0} = {1:.4g} to {2:.4g} m, boundary {3} lies from {4:.4g} to "
        "{5:.4g} m",
        axis, places.front(), places.back(), number, side.lo, side.hi);
    const double shared = std::min(places.back(), side.hi) - std::max(places.front(), side.lo);
    if (shared <= 0.0)
      throw InputError(s.file + ": boundary.profile_table", what,
                       "its places are in metres, counted as the box's are");
    if (shared < kLittle * (side.hi - side.lo))
      plan.warnings.push_back("boundary.profile_table " + what +
                              ": beyond its places the last factor stays");
  }
}

}  // namespace

void check_tables(const Scene& s, Plan& plan) {
  for (std::size_t i = 0; i < s.boundaries.size(); ++i) {
    check_times(s, s.boundaries[i].table, fmt::format("the table of boundary {}", i + 1), plan);
    check_profile(s, s.boundaries[i], i + 1, plan);
  }
  check_times(s, s.fluid.body_force_table, "fluid.body_force_table", plan);
}

}  // namespace lbm
