// SPDX-License-Identifier: GPL-2.0-or-later
#include "lbm_solver/solver/table_check.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <vector>

#include "lbm_solver/base/errors.h"
#include "lbm_solver/solver/place_check.h"

namespace lbm {
namespace {

constexpr double kLittle = 0.5;        // of a boundary that a profile covers
constexpr double kMuch = 10.0;         // of a boundary's length, or a run's time, that a table has
constexpr double kMoment = 1e-3;       // of a run's time that a table has
constexpr double kAMinute = 0.02;      // the same: what minutes make of seconds is a sixtieth
constexpr double kStepsATable = 20.0;  // that repeats

/// ", are they in µm?" where a table is that much too large.
std::string other_unit(double ratio, const char* unit) {
  constexpr const char* prefixes[] = {"m", "µ", "n"};
  const long thousands = std::lround(std::log10(ratio) / 3.0);
  if (thousands < 1) return "";
  return fmt::format(", are they in {}{}?", prefixes[std::min(thousands, 3L) - 1], unit);
}

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

/// Whether factors go one way only and end with something, as those of a soft start do.
bool is_ramp(const std::vector<double>& factors) {
  return factors.back() != 0.0 &&
         (std::ranges::is_sorted(factors) || std::ranges::is_sorted(factors, std::greater()));
}

/// A table of which the run sees little, or that it leaves behind at once.
void check_span(const Scene& s, const TimeTableScene& table, const std::string& key, Plan& plan) {
  std::vector<double> times = table.times;
  const std::vector<double>& factors = table.factors;
  if (!table.repeats)  // a value that stays says nothing, however long
    while (times.size() > 1 && factors[times.size() - 1] == factors[times.size() - 2])
      times.pop_back();
  if (times.size() < 2) return;
  if (const std::string odd = odd_times(times, table.repeats, s.end_time); !odd.empty())
    plan.warnings.push_back(key + " " + odd);
  else if (!table.repeats && times.back() < kAMinute * s.end_time && !is_ramp(factors))
    plan.warnings.push_back(fmt::format(
        "{} ends at {:.4g} s, after {:.2g} % of the run, and from then on has its last factor, "
        "{:.4g}; its times are in seconds, are they in minutes or hours?",
        key, times.back(), 100.0 * times.back() / s.end_time, factors.back()));
}

/// A table whose times the step does not resolve.
void check_steps(const Scene& s, const TimeTableScene& table, const std::string& key, Plan& plan) {
  if (table.times.empty()) return;
  const double span = table.times.back() - table.times.front(), steps = span / plan.units.dt;
  if (steps >= (table.repeats ? kStepsATable : 1.0)) return;
  const std::string text =
      fmt::format("{} goes from {:.4g} to {:.4g} s, {:.2g} fluid steps of {:.3g} s", key,
                  table.times.front(), table.times.back(), steps, plan.units.dt);
  const char* const remedy = "are its times in seconds? take a smaller numerics.time_step if so";
  if (table.repeats)
    throw InputError(
        fmt::format("{}: {}, of which a period needs at least {:.0f}", s.file, text, kStepsATable),
        remedy);
  plan.warnings.push_back(text + ": what it says in between is lost; " + remedy);
}

void check_both(const TimeTableScene& table, double frequency, const std::string& key, Plan& plan) {
  if (frequency > 0.0 && !table.times.empty())
    plan.warnings.push_back(
        fmt::format("{} stands beside a frequency: the value is multiplied by "
                    "both, by the table and by cos(2πft); leave one of them "
                    "out, if that is not meant",
                    key));
}

void check_table(const Scene& s, const TimeTableScene& table, double frequency,
                 const std::string& key, Plan& plan) {
  const std::size_t before = plan.warnings.size();
  check_steps(s, table, key, plan);
  if (plan.warnings.size() == before) check_span(s, table, key, plan);
  if (plan.warnings.size() == before) check_times(s, table, key, plan);
  check_both(table, frequency, key, plan);
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
    if (places.back() - places.front() > kMuch * (side.hi - side.lo))
      plan.warnings.push_back(
          fmt::format("boundary.profile_table {}: of the table only {:.2g} % lies on it; its "
                      "places are in metres{}",
                      what, 100.0 * shared / (places.back() - places.front()),
                      other_unit((places.back() - places.front()) / (side.hi - side.lo), "m")));
    if (shared < kLittle * (side.hi - side.lo))
      plan.warnings.push_back("boundary.profile_table " + what +
                              ": beyond its places the last factor stays");
  }
}

}  // namespace

std::string odd_times(const std::vector<double>& times, bool repeats, double end) {
  const double first = times.front(), last = times.back(), span = last - first;
  const std::string both =
      fmt::format("goes from {:.4g} to {:.4g} s, the run from 0 to {:.4g} s", first, last, end);
  const std::string seconds = "its times are in seconds";
  if (repeats)
    return span <= end ? ""
                       : fmt::format("{}: it ends after {:.2g} of the period; {}{}", both,
                                     end / span, seconds, other_unit(span / end, "s"));
  if (first >= end || last <= 0.0)
    return fmt::format("{}: all of it lies {} the run, which keeps its {} line; {}{}", both,
                       last <= 0.0 ? "before" : "behind", last <= 0.0 ? "last" : "first", seconds,
                       last <= 0.0 ? "" : other_unit(last / end, "s"));
  if (last > kMuch * end)
    return fmt::format("{}: only {:.2g} % of it acts; {}{}", both,
                       100.0 * (end - std::max(first, 0.0)) / span, seconds,
                       other_unit(last / end, "s"));
  if (last < kMoment * end)
    return fmt::format("{}: it is over after {:.2g} % of the run; {}", both, 100.0 * last / end,
                       seconds);
  return "";
}

void check_tables(const Scene& s, Plan& plan) {
  for (std::size_t i = 0; i < s.boundaries.size(); ++i) {
    const BoundaryScene& b = s.boundaries[i];
    check_table(s, b.table, b.frequency, fmt::format("the table of boundary {}", i + 1), plan);
    check_profile(s, b, i + 1, plan);
  }
  check_table(s, s.fluid.body_force_table, s.fluid.body_force_frequency, "fluid.body_force_table",
              plan);
}

}  // namespace lbm
