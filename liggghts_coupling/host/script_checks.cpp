// SPDX-License-Identifier: GPL-2.0-or-later
#include "liggghts_coupling/host/script_checks.h"

#include <atom.h>
#include <domain.h>
#include <fmt/format.h>
#include <modify.h>
#include <update.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "protocol/wire/errors.h"

namespace dem {
namespace {

/// Fixes whose particles are no single spheres.
constexpr std::array kClumps{"multisphere", "multisphere/nointegration", "multisphere/break",
                             "concave",     "nve/superquadric",          "nve/asphere",
                             "nve/line"};

template <class... Args>
[[noreturn]] void refuse(fmt::format_string<Args...> format, Args&&... args) {
  throw protocol::ProgramError(
      "fix lbm/couple: " + fmt::format(format, std::forward<Args>(args)...), protocol::kBadInput);
}

}  // namespace

void ScriptChecks::refuse_clumps() const {
  for (int i = 0; i < modify->nfix; ++i) {
    const auto& fix = *modify->fix[i];
    const std::string style = fix.style;
    if (std::find(kClumps.begin(), kClumps.end(), style) != kClumps.end())
      refuse(
          "fix {} {} moves particles that are no single spheres; they cannot couple yet: the fluid "
          "would count buoyancy and the fluid inside once a sphere. Use single spheres "
          "(fix nve/sphere)",
          fix.id, style);
    if (style != "rigid") continue;
    if (const auto pair = find_overlap(balls(fix.groupbit), box(), protocol::Depth::Surface))
      refuse(
          "fix {} {} joins spheres that overlap: {}. Such clumps cannot couple yet: the fluid "
          "would count buoyancy and the fluid inside once a sphere. Use spheres that do not "
          "overlap",
          fix.id, style, describe(*pair));
  }
}

void ScriptChecks::refuse_overlaps(int groupbit) const {
  if (const auto pair = find_overlap(balls(groupbit), box()))
    refuse("{}; the centre of one lies in the other: correct their places or diameters",
           describe(*pair));
}

void ScriptChecks::refuse_step(double step) const {
  const std::string culprit = fix_of_style("dt/reset");
  refuse(
      "the time step is {:.9g} s at step {}, agreed with the fluid was {:.9g} s; it cannot change "
      "in a coupled run: take out {}",
      update->dt, update->ntimestep, step, culprit.empty() ? "what changes it" : culprit);
}

void ScriptChecks::expect_box(const protocol::Hello& agreed) const {
  const protocol::Hello now = box();
  for (int k = 0; k < 3; ++k) {
    const double slack = 1e-9 * (agreed.box_hi[k] - agreed.box_lo[k]);
    if (std::abs(now.box_lo[k] - agreed.box_lo[k]) <= slack &&
        std::abs(now.box_hi[k] - agreed.box_hi[k]) <= slack)
      continue;
    const std::string culprit = fix_of_style("deform");
    refuse(
        "the box {} is {:.9g} … {:.9g} m at step {}, agreed with the fluid was {:.9g} … {:.9g} m; "
        "it cannot change in a coupled run: take out {}",
        "xyz"[k], now.box_lo[k], now.box_hi[k], update->ntimestep, agreed.box_lo[k],
        agreed.box_hi[k], culprit.empty() ? "what changes it (change_box)" : culprit);
  }
}

/// "fix ID STYLE" of the first that there is.
std::string ScriptChecks::fix_of_style(const std::string& style) const {
  for (int i = 0; i < modify->nfix; ++i)
    if (style == modify->fix[i]->style) return fmt::format("fix {} {}", modify->fix[i]->id, style);
  return {};
}

std::vector<protocol::Ball> ScriptChecks::balls(int groupbit) const {
  std::vector<protocol::Ball> balls;
  for (int i = 0; i < atom->nlocal; ++i) {
    const double* x = atom->x[i];
    const bool usable = std::isfinite(x[0] + x[1] + x[2]) && atom->radius[i] > 0.0;
    if ((atom->mask[i] & groupbit) && usable)
      balls.push_back({atom->tag[i], {x[0], x[1], x[2]}, atom->radius[i]});
  }
  return balls;
}

protocol::Hello ScriptChecks::box() const {
  protocol::Hello box;
  box.dimension = static_cast<std::uint32_t>(domain->dimension);
  for (int k = 0; k < 3; ++k) {
    box.box_lo[k] = domain->boxlo[k];
    box.box_hi[k] = domain->boxhi[k];
    box.periodic[k] = domain->periodicity[k] != 0;
  }
  return box;
}

}  // namespace dem
