// SPDX-License-Identifier: GPL-2.0-or-later
#include "lbm_solver/coupling/start_check.h"

#include <cmath>
#include <set>

#include "lbm_solver/base/errors.h"
#include "lbm_solver/coupling/solid_overlap.h"
#include "lbm_solver/solver/place_check.h"
#include "protocol/wire/clumps.h"

namespace lbm {
namespace {

constexpr double kDeepStart = 0.1;  // of the radius: more than packings are pressed together
constexpr double kLookedAt = 0.8;   // of the radius: where cells are asked
constexpr std::size_t kNamed = 3;   // particles

Vec3 place_of(const Scene& s, const protocol::Particle& p) {
  Vec3 x(p.state.x[0], p.state.x[1], s.box.dimension == 3 ? p.state.x[2] : 0.0);
  for (int k = 0; k < s.box.dimension; ++k)
    if (s.box.sides[k] == SideKind::Periodic)
      x[k] -= s.box.size[k] * std::floor((x[k] - s.box.origin[k]) / s.box.size[k]);
  return x;
}

/// Whether a rank's cells show that a ball may lie in an obstacle, or its place that it may in a
/// wall or in cells of another rank.
bool may_lie_in_solid(const Scene& s, const Plan& plan, const Fluid& fluid, const Vec3& x,
                      double r) {
  const Vec3 centre = plan.units.to_lattice_position(x);
  const Block& mine = fluid.cells();
  const auto covered = [&](const Vec3& place) {
    Cell3 cell{0, 0, 0};
    for (int k = 0; k < s.box.dimension; ++k) {
      const int n = plan.domain.cells()[k];
      cell[k] = static_cast<int>(std::floor(place[k]));
      if (s.box.sides[k] == SideKind::Periodic) cell[k] = (cell[k] + n) % n;
      if (cell[k] < 0 || cell[k] >= n) return true;  // beyond a wall
    }
    return !mine.holds(cell) ||
           fluid.solid_fraction(cell[0] - mine.begin[0], cell[1] - mine.begin[1],
                                cell[2] - mine.begin[2]) > 0.5;
  };
  if (covered(centre)) return true;
  for (int k = 0; k < s.box.dimension; ++k)
    for (const double way : {-kLookedAt, kLookedAt}) {
      Vec3 place = centre;
      place[k] += way * r / plan.units.dx;
      if (covered(place)) return true;
    }
  return false;
}

/// Numbers of the carriers of clumps, whose radius is that of a hull. Collective.
std::set<std::int64_t> hulls(const Fluid& fluid, const Particles& particles) {
  std::vector<double> carriers;
  for (const protocol::Particle& p : particles.states())
    if (protocol::is_part(p.shape)) carriers.push_back(static_cast<double>(p.shape.carrier));
  std::set<std::int64_t> all;  // known to rank 0
  for (const double id : fluid.ranks().collect(carriers)) all.insert(static_cast<std::int64_t>(id));
  return all;
}

}  // namespace

DeepStarts warn_of_starts(const Scene& s, const Plan& plan, const Fluid& fluid,
                          const Particles& particles, Log& log) {
  std::vector<double> lines;  // number, place and radius of those that may
  for (const protocol::Particle& p : particles.states()) {
    const Vec3 x = place_of(s, p);
    if (p.shape.radius > 0.0 && may_lie_in_solid(s, plan, fluid, x, p.shape.radius))
      lines.insert(lines.end(),
                   {static_cast<double>(p.state.id), x[0], x[1], x[2], p.shape.radius});
  }
  lines = fluid.ranks().collect(lines);
  const std::set<std::int64_t> clumps = hulls(fluid, particles);
  DeepStarts found;
  std::string in_surface;  // of which and what
  for (std::size_t i = 0; i + 4 < lines.size(); i += 5) {
    const double r = lines[i + 4];
    const Vec3 x(lines[i + 1], lines[i + 2], lines[i + 3]);
    if (clumps.contains(static_cast<std::int64_t>(lines[i]))) continue;
    const auto in = solid_overlaps(s, x, r, 0.0);
    if (in.empty() || in[0].depth < kDeepStart * r) continue;
    found.emplace(static_cast<std::int64_t>(lines[i]),
                  fmt::format("{:.3g} of its radius deep in {}", in[0].depth / r, in[0].what));
    if (in[0].on_surface)
      in_surface = fmt::format("particle {} begins at {}, its centre in the surface of {}",
                               static_cast<std::int64_t>(lines[i]), place_text(s, x), in[0].what);
  }
  if (fluid.ranks().max(in_surface.empty() ? 0.0 : 1.0) > 0.0)
    throw InputError(
        in_surface.empty() ? "a particle begins in a surface" : in_surface,
        "a contact there has no direction, and the solid stops with \"Internal error\"",
        "start it beside the obstacle");
  std::size_t said = 0;
  for (const auto& [id, where] : found)
    if (++said <= kNamed)
      log.say(0, "warning",
              "particle {} begins {}: a contact throws it out; start it outside, or leave out the "
              "wall that its script does not have",
              id, where);
  if (found.size() > kNamed)
    log.say(0, "warning", "… and {} more particles begin deep in a solid", found.size() - kNamed);
  return found;
}

void warn_of_count(const std::optional<std::int64_t>& told, const Decomposition& ranks,
                   const Particles& particles, Log& log) {
  if (!told) return;
  double here = static_cast<double>(particles.carriers_at_home());
  ranks.sum({&here, 1});
  if (here == static_cast<double>(*told)) return;
  log.say(0, "warning",
          "the solid's handshake counts {} particles (a clump is one), {:.0f} of them lie in the "
          "box at the start: the fluid acts on no other; look at what the solid sends, and where "
          "its particles begin",
          *told, here);
}

}  // namespace lbm
