// SPDX-License-Identifier: GPL-2.0-or-later
#include "liggghts_coupling/host/script_checks.h"

#include <atom.h>
#include <domain.h>
#include <fmt/core.h>
#include <modify.h>
#include <update.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "protocol/solid/particle_coupling.h"
#include "protocol/wire/errors.h"

namespace dem {
namespace {

/// Fixes whose particles are neither single spheres nor clumps that stay whole and move.
constexpr std::array kOthers{"multisphere/nointegration", "multisphere/break", "concave",
                             "nve/superquadric",          "nve/asphere",       "nve/line"};

template <class... Args>
[[noreturn]] void refuse(fmt::format_string<Args...> format, Args&&... args) {
  throw protocol::ProgramError(
      "fix lbm/couple: " + fmt::format(format, std::forward<Args>(args)...), protocol::kBadInput);
}

}  // namespace

void ScriptChecks::refuse_other_shapes() const {
  for (int i = 0; i < modify->nfix; ++i) {
    const auto& fix = *modify->fix[i];
    const std::string style = fix.style;
    if (std::find(kOthers.begin(), kOthers.end(), style) != kOthers.end())
      refuse(
          "fix {} {} has particles that are neither spheres nor rigid bodies of them; they cannot "
          "couple. Use spheres (fix nve/sphere) or clumps (fix multisphere, fix rigid)",
          fix.id, style);
  }
}

bool ScriptChecks::joins_overlapping(int groupbit) const {
  return find_overlap(balls(groupbit), box(), protocol::Depth::Surface).has_value();
}

void ScriptChecks::refuse_overlaps(int groupbit, const std::int64_t* carriers) const {
  if (const auto pair = find_overlap(balls(groupbit, carriers), box()))
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

std::vector<protocol::Ball> ScriptChecks::balls(int groupbit, const std::int64_t* carriers) const {
  return protocol::balls_of({.count = atom->nlocal,
                             .id = atom->tag,
                             .mask = atom->mask,
                             .radius = atom->radius,
                             .x = atom->x,
                             .carrier = carriers},
                            groupbit);
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
