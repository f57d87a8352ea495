// SPDX-License-Identifier: GPL-2.0-or-later
#include "lbm_solver/coupling/start_check.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "lbm_solver/base/errors.h"
#include "lbm_solver/coupling/solid_overlap.h"
#include "lbm_solver/solver/place_check.h"
#include "protocol/wire/clumps.h"
#include "protocol/wire/names.h"

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
  constexpr std::size_t kWidth = 6;
  std::vector<double> lines;  // number, place, radius and carrier of those that may
  for (const protocol::Particle& p : particles.states()) {
    const Vec3 x = place_of(s, p);
    if (p.shape.radius > 0.0 && may_lie_in_solid(s, plan, fluid, x, p.shape.radius))
      lines.insert(lines.end(), {static_cast<double>(p.state.id), x[0], x[1], x[2], p.shape.radius,
                                 static_cast<double>(protocol::carrier_of(p.shape))});
  }
  lines = fluid.ranks().collect(lines);
  const std::set<std::int64_t> clumps = hulls(fluid, particles);
  DeepStarts found;
  std::map<std::int64_t, std::string> said;
  std::string in_surface;  // of which and what
  for (std::size_t i = 0; i + kWidth <= lines.size(); i += kWidth) {
    const double r = lines[i + 4];
    const Vec3 x(lines[i + 1], lines[i + 2], lines[i + 3]);
    const protocol::Shape shape{.id = static_cast<std::int64_t>(lines[i]),
                                .carrier = static_cast<std::int64_t>(lines[i + 5])};
    if (clumps.contains(shape.id)) continue;
    const auto in = solid_overlaps(s, x, r, 0.0);
    if (in.empty() || in[0].depth < kDeepStart * r) continue;
    const std::string deep =
        fmt::format("{:.3g} of its radius deep in {}", in[0].depth / r, in[0].what);
    found.emplace(shape.id, deep);
    said.emplace(shape.id,
                 fmt::format("{} begins {}: {}; start it outside, or leave out the wall that its "
                             "script does not have",
                             name_of(shape), deep,
                             in[0].keeps ? "its centre lies inside, from where no contact with "
                                           "the surface brings it out"
                                         : "a contact throws it out"));
    if (in[0].on_surface)
      in_surface = fmt::format("{} begins at {}, its centre in the surface of {}", name_of(shape),
                               place_text(s, x), in[0].what);
  }
  if (fluid.ranks().max(in_surface.empty() ? 0.0 : 1.0) > 0.0)
    throw InputError(
        in_surface.empty() ? "a particle begins in a surface" : in_surface,
        "a contact there has no direction, and the solid stops with \"Internal error\"",
        "start it beside the obstacle");
  std::size_t told = 0;
  for (const auto& [id, text] : said)
    if (++told <= kNamed) log.say(0, "warning", "{}", text);
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

namespace {

/// The box around a mesh that moves, at rest, and where it is.
struct Mover {
  Pose pose;
  Vec3 low, high;

  bool may_hold(const Vec3& place) const {
    const Eigen::AngleAxisd back(-pose.angle, pose.axis);
    const Vec3 at_rest = pose.pivot + Vec3(back * Vec3(place - pose.centre()));
    return (at_rest.array() >= low.array()).all() && (at_rest.array() <= high.array()).all();
  }
};

std::vector<Mover> movers_of(const Scene& s, double time) {
  std::vector<Mover> movers;
  for (const ObstacleScene& o : s.obstacles) {
    if (!o.mesh || !o.motion || o.motion->surface_only) continue;
    const auto [low, high] = bounds(*o.mesh->surface);
    movers.push_back({pose_at(*o.motion, time), low, high});
  }
  return movers;
}

}  // namespace

std::string buried_text(const Scene& s, std::span<const protocol::Particle> particles, double time,
                        const DeepStarts& starts) {
  const std::vector<Mover> movers = movers_of(s, time);
  if (movers.empty()) return {};
  std::size_t count = 0;
  std::string first;
  for (const protocol::Particle& p : particles) {
    const double r = p.shape.radius;  // 0: of a clump its spheres are there
    const Vec3 x = place_of(s, p);
    if (r <= 0.0 || starts.contains(p.state.id) ||
        std::ranges::none_of(movers, [&](const Mover& m) { return m.may_hold(x); }))
      continue;
    const auto in = solid_overlaps(s, x, r, time);
    const auto mover = std::ranges::find_if(in, [](const auto& o) { return o.moves && o.keeps; });
    if (mover == in.end() || ++count > 1) continue;
    first = fmt::format("{} lies {:.3g} of its radius deep in {}, which moves", name_of(p.shape),
                        mover->depth / r, mover->what);
  }
  if (count == 0) return {};
  return first + (count > 1 ? fmt::format(", and so do {} more", count - 1) : "") +
         ": what moves has gone over it, and no contact with its surface brings it out; let it "
         "move slower, take stiffer contacts (particles.contact_stiffness and the script's) or "
         "more coupling.substeps";
}

}  // namespace lbm
