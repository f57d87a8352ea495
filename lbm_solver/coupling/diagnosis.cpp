// SPDX-License-Identifier: GPL-2.0-or-later
#include "lbm_solver/coupling/diagnosis.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "lbm_solver/coupling/solid_overlap.h"
#include "lbm_solver/solver/driven_speed.h"
#include "protocol/wire/clumps.h"
#include "protocol/wire/names.h"

namespace lbm {
namespace {

constexpr double kUnstableGrowth = 1.03;  // a step: tenfold in 78 steps, faster than flows do
constexpr double kDeepOverlap = 0.05;     // over the smaller radius
constexpr double kNear = 2.0;             // radii from the surface: what a particle stirs up
constexpr double kMuchFaster = 2.0;       // than velocity_scale

/// Shortest way from a to b in the box.
Vec3 between(const Scene& s, const protocol::Vec3& a, const protocol::Vec3& b) {
  Vec3 way(b[0] - a[0], b[1] - a[1], b[2] - a[2]);
  for (int k = 0; k < s.box.dimension; ++k)
    if (s.box.sides[k] == SideKind::Periodic) way[k] = std::remainder(way[k], s.box.size[k]);
  return way;
}

struct Near {
  const protocol::Particle* particle = nullptr;
  double distance = std::numeric_limits<double>::infinity();  ///< of its surface [m]
  const protocol::Particle* partner = nullptr;                ///< that it overlaps most
  double overlap = 0.0;                                       ///< over the smaller radius
};

double speed_of(const protocol::Particle& p) {
  return std::hypot(p.state.v[0], p.state.v[1], p.state.v[2]);
}

/// The particle nearest to a place, without one the fastest.
Near nearest(const Scene& s, const std::optional<Vec3>& at,
             const std::vector<protocol::Particle>& particles) {
  Near near;
  for (const auto& p : particles) {
    if (p.shape.radius == 0.0) continue;  // a clump: its spheres are there
    if (!at) {
      if (!near.particle || speed_of(p) > speed_of(*near.particle)) near = {&p, 0.0};
      continue;
    }
    const double distance =
        between(s, {at->x(), at->y(), at->z()}, p.state.x).norm() - p.shape.radius;
    if (distance < near.distance) near = {&p, distance};
  }
  if (!near.particle) return near;
  for (const auto& q : particles) {
    if (&q == near.particle || q.shape.radius == 0.0) continue;
    if (is_part(q.shape) && q.shape.carrier == near.particle->shape.carrier) continue;
    const double sum = q.shape.radius + near.particle->shape.radius;
    const double deep = (sum - between(s, near.particle->state.x, q.state.x).norm()) /
                        std::min(q.shape.radius, near.particle->shape.radius);
    if (deep > near.overlap) {
      near.overlap = deep;
      near.partner = &q;
    }
  }
  return near;
}

/// What a particle lies in deeply beside other particles.
std::vector<SolidOverlap> deep_in(const Scene& s, const protocol::Particle& p, double time) {
  Vec3 centre(p.state.x[0], p.state.x[1], s.box.dimension == 3 ? p.state.x[2] : 0.0);
  for (int k = 0; k < s.box.dimension; ++k)  // the solid wraps it now and then only
    if (s.box.sides[k] == SideKind::Periodic)
      centre[k] -= s.box.size[k] * std::floor((centre[k] - s.box.origin[k]) / s.box.size[k]);
  auto found = solid_overlaps(s, centre, p.shape.radius, time);
  std::erase_if(found, [&](const auto& o) { return o.depth < kDeepOverlap * p.shape.radius; });
  return found;
}

/// Says so, and what to do: it is pressed between two, by what moves, or began there.
std::string overlap_text(const std::vector<SolidOverlap>& in, double radius, std::string& cure) {
  const auto name = [&](const SolidOverlap& o) {
    return fmt::format("{:.3g} of its radius deep in {}{}{}", o.depth / radius, o.what,
                       o.moves ? ", which moves" : "",
                       o.depth > radius ? " (its centre is inside)" : "");
  };
  std::string text = " It lies " + name(in[0]);
  if (in.size() > 1) text += ", and " + name(in[1]);
  if (in.size() > 1 && (in[0].moves || in[1].moves))
    cure =
        "it is crushed between the two: leave room for a particle between what moves and what it "
        "comes to, or let it come slower";
  else if (in[0].moves)
    cure =
        "what moves has run into it: let it move slower, take stiffer contacts "
        "(particles.contact_stiffness and the script's) or more coupling.substeps";
  else
    cure =
        "its contact throws it out: start particles outside of obstacles and walls (the script may "
        "place them elsewhere than the scene); where they were pressed in, take stiffer contacts "
        "(particles.contact_stiffness and the script's) or more coupling.substeps";
  return text + ".";
}

/// Of one that began deep in a solid, if it is the one beside, or is no longer there.
/// @param beside  null: there is none
std::string thrown_text(const DeepStarts& starts, const protocol::Particle* beside,
                        const std::vector<protocol::Particle>& particles) {
  if (beside && starts.contains(beside->state.id))
    return fmt::format(" It began {}, and was thrown out.", starts.at(beside->state.id));
  for (const auto& [id, where] : starts)
    if (std::ranges::none_of(particles, [&](const auto& p) { return p.state.id == id; }))
      return fmt::format(" Particle {} began {}, was thrown out, and has left the box since.", id,
                         where);
  return {};
}

double solid_part(const Scene& s, const std::vector<protocol::Particle>& particles) {
  double volume = 0.0, box = 1.0;
  for (const auto& p : particles) volume += particle_volume(s, 2.0 * p.shape.radius);
  for (int k = 0; k < s.box.dimension; ++k) box *= s.box.size[k];
  return volume / (box * (s.box.dimension == 2 ? s.box.depth : 1.0));
}

}  // namespace

void SpeedRecord::add(std::int64_t step, double speed) {
  if (looks_.size() == 2) looks_.erase(looks_.begin());
  looks_.push_back({step, speed});
}

std::int64_t SpeedRecord::steps_between() const {
  return looks_.size() < 2 ? 0 : looks_[1].step - looks_[0].step;
}

double SpeedRecord::before() const {
  return looks_.empty() ? 0.0 : looks_.front().speed;
}

std::optional<double> SpeedRecord::growth() const {
  if (steps_between() <= 0 || !(looks_[0].speed > 0.0)) return {};
  // a state that is not finite has grown by ten powers at least
  const double ratio = std::isfinite(looks_[1].speed) ? looks_[1].speed / looks_[0].speed : 1e10;
  return std::pow(ratio, 1.0 / static_cast<double>(steps_between()));
}

std::string diagnosis(const Scene& s, const Plan& plan, double time, const std::optional<Vec3>& at,
                      const SpeedRecord& record, const std::vector<protocol::Particle>& particles,
                      const DeepStarts& starts) {
  std::string text, cure;
  const Near near = nearest(s, at, particles);
  const std::optional<double> growth = record.growth();
  const bool unstable = growth && *growth > kUnstableGrowth;
  if (growth)
    text += fmt::format(
        " {} steps before the largest speed was {:.3g} m/s: it grew by a factor "
        "{:.3g} a step{}.",
        record.steps_between(), record.before() * plan.units.velocity(), *growth,
        unstable ? ", which is an instability or a blow" : "");
  const bool beside = near.particle && near.distance < kNear * near.particle->shape.radius;
  if (near.particle && at)
    text += fmt::format(" The nearest is {}, {:.3g} radii from there, at {:.3g} m/s.",
                        name_of(near.particle->shape),
                        std::max(0.0, near.distance / near.particle->shape.radius),
                        speed_of(*near.particle));
  else if (near.particle)
    text += fmt::format(" It is {}.", name_of(near.particle->shape));
  const std::vector<Drive> driven = drives(s);
  const auto in = beside ? deep_in(s, *near.particle, time) : std::vector<SolidOverlap>();
  if (!in.empty() && in[0].depth > near.overlap * near.particle->shape.radius) {
    text += overlap_text(in, near.particle->shape.radius, cure);
  } else if (near.partner && near.overlap > kDeepOverlap && beside) {
    text += fmt::format(" It overlaps {} by {:.3g} of a radius.", name_of(near.partner->shape),
                        near.overlap);
    cure =
        "their contact throws them apart: start particles apart, or relax the packing before "
        "the coupling; where they were pressed together, take stiffer contacts "
        "(particles.contact_stiffness and the script's) or more coupling.substeps";
  } else if (const std::string thrown =
                 thrown_text(starts, beside ? near.particle : nullptr, particles);
             !thrown.empty()) {
    text += thrown;
    cure = "start it outside, as the warning at the start says";
  } else if (!driven.empty() && driven.front().speed > kMuchFaster * s.fluid.velocity_scale) {
    text += fmt::format(" {} can give {:.3g} m/s.", driven.front().what, driven.front().speed);
    cure = fmt::format(
        "look at its value and unit; if it is meant, set fluid.velocity_scale to "
        "the speed that you expect, {:.3g} m/s at most (now {:.3g})",
        driven.front().speed, s.fluid.velocity_scale);
  } else if (unstable) {
    text +=
        fmt::format(" τ = {:.4g}, Re_h = {:.3g}", plan.kernel.parameters.tau, plan.reynolds_cell);
    if (s.particles)
      text += fmt::format(", density of the particles over the fluid's {:.3g}, solid part {:.2g}",
                          s.particles->density.lo / s.fluid.density, solid_part(s, particles));
    text += ".";
    cure = beside ? "if it starts at particles, take more cells a diameter, or for particles about "
                    "as light as the fluid coupling.virtual_mass = 1 or more"
                  : "take more cells, or numerics.collision = \"central_moment\", which is stable "
                    "at larger Re_h";
  } else {
    const bool thrown = near.particle && !at;
    if (!driven.empty())
      text += fmt::format(" What drives most is {}, good for {:.3g} m/s.", driven.front().what,
                          driven.front().speed);
    cure = fmt::format(
        "if this {} is right, set fluid.velocity_scale to its largest speed (now {:.3g} m/s); else "
        "look at {}",
        thrown ? "motion" : "flow", s.fluid.velocity_scale,
        thrown ? "the velocity that the particle was given, and at its contacts"
               : "what drives it");
  }
  return text + " What to do: " + cure;
}

}  // namespace lbm
