// SPDX-License-Identifier: MIT
#include "protocol/wire/clumps.h"

#include <algorithm>
#include <cmath>

#include "protocol/wire/ball_union.h"
#include "protocol/wire/names.h"
#include "protocol/wire/refusal.h"

namespace protocol {
namespace {

/// Of a clump's volume against that of its spheres. A solid may find it by sampling (LIGGGHTS, 0.3
/// % with 1e5 tries, which it calls its least); an error of a hundredth lifts a clump by a
/// hundredth of what it displaces, which is what the lattice itself is wrong by at eight cells a
/// sphere.
constexpr double kVolume = 0.01;
constexpr double kClumpSlack = 1e-6;

}  // namespace

/// The shortest over periodic images.
Vec3 ClumpCheck::arm(const State& sphere, const State& carrier) const {
  Vec3 arm{};
  for (unsigned k = 0; k < fluid_.dimension; ++k) {
    const double length = fluid_.box_hi[k] - fluid_.box_lo[k];
    arm[k] = sphere.x[k] - carrier.x[k];
    if (fluid_.periodic[k]) arm[k] -= length * std::round(arm[k] / length);
  }
  return arm;
}

ClumpCheck::Clumps ClumpCheck::find(std::span<const Particle> particles,
                                    std::int64_t interval) const {
  Clumps clumps;
  const auto before = [](const Particle& p, std::int64_t id) { return p.state.id < id; };
  for (std::size_t i = 0; i < particles.size(); ++i) {
    const Shape& shape = particles[i].shape;
    if (!is_part(shape)) continue;
    Clump& clump = clumps[shape.carrier];
    if (clump.spheres.empty()) {
      const auto at = std::lower_bound(particles.begin(), particles.end(), shape.carrier, before);
      if (at == particles.end() || at->state.id != shape.carrier)
        refuse(
            "{} is a sphere of {}, which did not come with it at interval {}{}: a clump comes "
            "whole, its carrier and all its spheres",
            name_of(shape.id), name_of(shape.carrier, true), interval, where(particles[i].state.x));
      if (is_part(at->shape))
        refuse("{} is a sphere of {}, which is a sphere of {} itself (interval {})",
               name_of(shape.id), name_of(shape.carrier, true), name_of(at->shape.carrier, true),
               interval);
      clump.carrier = static_cast<std::size_t>(at - particles.begin());
    }
    clump.spheres.push_back(i);
  }
  return clumps;
}

void ClumpCheck::volume(std::span<const Particle> particles, const Clump& clump,
                        std::int64_t interval) const {
  const auto& [state, shape] = particles[clump.carrier];
  std::vector<Ball> balls;
  for (const std::size_t i : clump.spheres)
    balls.push_back({0, arm(particles[i].state, state), particles[i].shape.radius});
  const double together = moments_of_union(balls, fluid_.dimension, fluid_.depth).volume;
  const double tolerance = balls.size() == 1 ? kClumpSlack : kVolume;
  if (std::abs(shape.volume - together) <= tolerance * together) return;
  refuse(
      "{}: volume {:.6g} m³ at interval {}{}, its {} spheres fill {:.6g} m³ together: it would be "
      "lifted by what it says; tell the volume of their union, to 1 % (LIGGGHTS: raise ntry of its "
      "template)",
      name_of(shape.id, true), shape.volume, interval, where(state.x), clump.spheres.size(),
      together);
}

void ClumpCheck::learn(std::span<const Particle> particles, std::span<const std::int64_t> told,
                       std::int64_t interval) {
  const Clumps before = std::exchange(clumps_, find(particles, interval));
  places(particles, interval);
  const auto is_told = [&](std::size_t i) {
    return std::binary_search(told.begin(), told.end(), particles[i].state.id);
  };
  for (const auto& [id, clump] : clumps_) {
    for (unsigned k = 0; k < fluid_.dimension; ++k) {
      const double radius = particles[clump.carrier].shape.radius;
      const double length = fluid_.box_hi[k] - fluid_.box_lo[k];
      if (fluid_.periodic[k] && 2.0 * radius > length)
        refuse("{}: radius {:.6g} m at interval {}, the box has {:.6g} m on a periodic axis",
               name_of(id, true), radius, interval, length);
    }
    const auto was = before.find(id);
    const bool other = was == before.end() || was->second.spheres.size() != clump.spheres.size();
    if (other || is_told(clump.carrier) || std::ranges::any_of(clump.spheres, is_told))
      volume(particles, clump, interval);
  }
  for (const Particle& p : particles)
    if (before.contains(p.state.id) && !clumps_.contains(p.state.id))
      refuse(
          "{} came without its spheres at interval {}{}: a clump comes whole; one that falls apart "
          "leaves, and its spheres come with other ids",
          name_of(p.state.id, true), interval, where(p.state.x));
}

void ClumpCheck::places(std::span<const Particle> particles, std::int64_t interval) const {
  for (const auto& [id, clump] : clumps_) {
    const auto& [state, shape] = particles[clump.carrier];
    for (const std::size_t i : clump.spheres) {
      const Vec3 a = arm(particles[i].state, state);
      const double out = std::hypot(a[0], a[1], a[2]) + particles[i].shape.radius;
      if (out <= shape.radius * (1.0 + kClumpSlack)) continue;
      refuse(
          "{}: its sphere {} reaches {:.9g} m from its centre at interval {}{}, its radius is "
          "{:.9g} m: that of the ball about its centre that holds all its spheres",
          name_of(id, true), particles[i].state.id, out, interval, where(particles[i].state.x),
          shape.radius);
    }
  }
}

}  // namespace protocol
