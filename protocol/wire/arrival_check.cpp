// SPDX-License-Identifier: MIT
#include "protocol/wire/arrival_check.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "protocol/wire/names.h"
#include "protocol/wire/overlap.h"
#include "protocol/wire/refusal.h"

namespace protocol {
namespace {

constexpr double kRoundOff = 1e-9;  // of numbers that come through a script's decimal text
constexpr double kSlack = 1e-6;     // of ranges and masses
constexpr double kUnion = 1e-4;     // of a clump's density: its volume is measured (ball_union.cpp)
constexpr double kGrowth = 0.1;     // of a radius between two exchanges

std::string text(const Vec3& v) {
  return format("({:.6g}, {:.6g}, {:.6g})", v[0], v[1], v[2]);
}

double norm(const Vec3& v) {
  return std::hypot(v[0], v[1], v[2]);
}

void expect_finite(std::int64_t id, const Vec3& value, const char* what, std::int64_t interval) {
  if (std::isfinite(value[0]) && std::isfinite(value[1]) && std::isfinite(value[2])) return;
  throw BadMessage(format("{}: {} is ({}, {}, {}) at interval {}: not finite", name_of(id), what,
                          value[0], value[1], value[2], interval),
                   kNumerics);
}

}  // namespace

ArrivalCheck::ArrivalCheck(const Hello& fluid)
    : fluid_(fluid), interval_(fluid.step * fluid.fluid_steps) {
  constexpr double far = std::numeric_limits<double>::infinity();
  for (unsigned k = 0; k < 3; ++k) {
    length_[k] = fluid.box_hi[k] - fluid.box_lo[k];
    counts_[k] = k < fluid.dimension ? 1.0 : 0.0;
    const bool ends = k < fluid.dimension && !fluid.periodic[k];
    lo_[k] = ends ? fluid.box_lo[k] - fluid.reach : -far;
    hi_[k] = ends ? fluid.box_hi[k] + fluid.reach : far;
  }
}

void ArrivalCheck::setting(const Setting& now, std::int64_t interval) const {
  const double step = interval_ / fluid_.solid_steps;
  if (!(std::abs(now.step - step) <= kRoundOff * step))
    refuse(
        "interval {}: the solid's time step is {:.9g} s, agreed was {:.9g} s; it cannot change in "
        "a coupled run: take out what changes it (fix dt/reset, timestep)",
        interval, now.step, step);
  const char* axis[] = {"x", "y", "z"};
  const auto same = [&](double a, double b, int k) {
    return std::abs(a - b) <= kRoundOff * length_[k];
  };
  for (int k = 0; k < 3; ++k) {
    const bool depth_only = k == 2 && fluid_.dimension == 2;
    const bool good = depth_only ? same(now.box_hi[k] - now.box_lo[k], fluid_.depth, k)
                                 : same(now.box_lo[k], fluid_.box_lo[k], k) &&
                                       same(now.box_hi[k], fluid_.box_hi[k], k);
    if (!good)
      refuse(
          "interval {}: the solid's box {} is {:.9g} … {:.9g} m, agreed was {:.9g} … {:.9g} m; it "
          "cannot change in a coupled run: take out what changes it (fix deform, change_box)",
          interval, axis[k], now.box_lo[k], now.box_hi[k], fluid_.box_lo[k], fluid_.box_hi[k]);
  }
}

double ArrivalCheck::agreed_volume(double radius) const {
  const double disc = std::numbers::pi * radius * radius;
  return fluid_.dimension == 2 ? disc * fluid_.depth : disc * radius * 4.0 / 3.0;
}

void ArrivalCheck::shape(const Shape& s, const Shape* known, bool clump,
                         std::int64_t interval) const {
  const auto positive = [](double value) { return std::isfinite(value) && value > 0.0; };
  const bool part = is_part(s);
  if (part && (s.mass != 0.0 || s.inertia != 0.0 || s.volume != 0.0))
    refuse(
        "{} is a sphere of {}, but has a mass of {} kg, an inertia of {} kg m² and "
        "a volume of {} m³ at interval {}: the clump has them, a sphere of it says 0",
        name_of(s.id), name_of(s.carrier, true), s.mass, s.inertia, s.volume, interval);
  if (!positive(s.radius) || (!part && (!positive(s.mass) || !positive(s.inertia))))
    refuse("{}: radius {} m, mass {} kg, inertia {} kg m² must be positive (interval {})",
           name_of(s.id, clump), s.radius, s.mass, s.inertia, interval);
  clump = clump && !part;
  if (clump && !positive(s.volume))
    refuse("{}: volume {} m³ at interval {}: tell that of the union of its spheres",
           name_of(s.id, true), s.volume, interval);
  if (s.type < 1)
    refuse("{}: type {} at interval {}: types begin at 1", name_of(s.id, clump), s.type, interval);
  if (!clump) sizes(s, interval);
  if (!part) inertia(s, clump, interval);
  if (known && known->epoch == s.epoch &&
      std::abs(s.radius - known->radius) > kGrowth * known->radius)
    refuse(
        "{}: radius {:.6g} m at interval {}, {:.6g} m one exchange before: let it grow by less "
        "than "
        "a tenth between two, or begin it anew with another epoch",
        name_of(s.id, clump), s.radius, interval, known->radius);
}

namespace {

bool within(double value, const std::optional<Range>& range, double part = kSlack) {
  const double slack = range ? part * range->hi : 0.0;
  return !range || (value >= range->lo - slack && value <= range->hi + slack);
}

}  // namespace

/// Of what covers cells: a grain, or a sphere of a clump.
void ArrivalCheck::sizes(const Shape& s, std::int64_t interval) const {
  const int longest = fluid_.dimension == 2 ? 2 : 3;
  const double side = *std::min_element(length_.begin(), length_.begin() + longest);
  if (s.radius > side)
    refuse("particle {}: radius {:.6g} m at interval {} is larger than the box ({:.6g} m)", s.id,
           s.radius, interval, side);
  if (!within(s.radius, fluid_.radius))
    refuse(
        "particle {}: diameter {:.6g} m at interval {}, the scene's particles.diameter says {:.6g} "
        "… {:.6g} m; correct one of them",
        s.id, 2.0 * s.radius, interval, 2.0 * fluid_.radius->lo, 2.0 * fluid_.radius->hi);
  const double volume = agreed_volume(s.radius);
  if (s.volume != 0.0 && !(std::abs(s.volume - volume) <= kSlack * volume))
    refuse("particle {}: volume {:.6g} m³ at interval {}, a ball of its radius has {:.6g} m³", s.id,
           s.volume, interval, volume);
}

/// Of what has a mass: a grain, or a clump.
void ArrivalCheck::inertia(const Shape& s, bool clump, std::int64_t interval) const {
  const double volume = clump ? s.volume : agreed_volume(s.radius);
  const double density = s.mass / volume;
  if (!within(density, fluid_.density, clump ? kUnion : kSlack))
    refuse(
        "{}: density {:.6g} kg/m³ at interval {} (mass {:.6g} kg in {:.6g} m³), the "
        "scene's particles.density says {:.6g} … {:.6g} kg/m³; correct one of them{}",
        name_of(s.id, clump), density, interval, s.mass, volume, fluid_.density->lo,
        fluid_.density->hi,
        fluid_.dimension == 2
            ? format("; a disc has a mass of π r² × density × the depth of {:.6g} m", fluid_.depth)
            : "");
  if (const double most = s.mass * s.radius * s.radius; s.inertia > most * (1.0 + kSlack))
    refuse(
        "{}: inertia {:.6g} kg m² at interval {}: no ball of {:.6g} kg and radius {:.6g} m has "
        "more "
        "than {:.6g} kg m²",
        name_of(s.id, clump), s.inertia, interval, s.mass, s.radius, most);
}

/// On an axis that is not periodic, no farther out than a particle that touches fluid.
bool ArrivalCheck::inside(const Particle& now) const {
  const double r = now.shape.radius * (1.0 + kRoundOff);
  const Vec3& x = now.state.x;
  for (int k = 0; k < 3; ++k)
    if (x[k] + r < lo_[k] || x[k] - r > hi_[k]) return false;
  return true;
}

double ArrivalCheck::moved(const State& now, const State& before, unsigned k) const {
  const double way = now.x[k] - before.x[k];
  return fluid_.periodic[k] ? way - length_[k] * std::round(way / length_[k]) : way;
}

/// The fastest that it can have been without a contact: the faster of its two velocities, and what
/// loads and gravity add in an interval (overlapped, loads act one interval later).
double ArrivalCheck::fastest(const State& now, const State& before) const {
  const double kick = std::max(kicks_[0], kicks_[1]) + norm(fluid_.gravity);
  return std::max(norm(now.v), norm(before.v)) + kick * interval_;
}

/// No more than a diameter farther than twice the way at that speed.
bool ArrivalCheck::near(const Particle& now, const State& before) const {
  double squares = 0.0;
  for (unsigned k = 0; k < fluid_.dimension; ++k) {
    const double way = moved(now.state, before, k);
    squares += way * way;
  }
  return std::sqrt(squares) <= 2.0 * (now.shape.radius + interval_ * fastest(now.state, before));
}

void ArrivalCheck::examine(const Particle& now, const State* before, std::int64_t interval) const {
  const auto& [s, shape] = now;
  expect_finite(s.id, s.x, "position", interval);
  expect_finite(s.id, s.v, "velocity", interval);
  expect_finite(s.id, s.omega, "angular velocity", interval);
  if (!in_plane(s, shape))
    refuse(
        "{} leaves the plane at interval {}: velocity {} m/s, angular velocity {} rad/s; "
        "in two dimensions v_z, ω_x and ω_y are 0 (LIGGGHTS: fix enforce2d)",
        name_of(s.id), interval, text(s.v), text(s.omega));
  if (is_part(shape)) return;  // its place is held against its carrier's
  if (!inside(now)) {
    double out = 0.0;
    for (unsigned k = 0; k < fluid_.dimension; ++k)
      if (!fluid_.periodic[k])
        out = std::max({out, fluid_.box_lo[k] - s.x[k], s.x[k] - fluid_.box_hi[k]});
    refuse(
        "{}: its centre {} m lies {:.6g} m outside of the box at interval {}, its radius "
        "is {:.6g} m; a solid sends no particle that touches no fluid",
        name_of(s.id), text(s.x), out, interval, shape.radius);
  }
  if (!before || near(now, *before)) return;
  Vec3 way{};
  for (unsigned k = 0; k < fluid_.dimension; ++k) way[k] = moved(s, *before, k);
  const double diameter = 2.0 * shape.radius;
  refuse(
      "{} jumped from {} to {} m in interval {}: {:.3g} diameters, where its velocity and load "
      "explain {:.3g}; contacts have thrown it, or it was put there (then it begins anew, with "
      "another epoch)",
      name_of(s.id), text(before->x), text(s.x), interval, norm(way) / diameter,
      interval_ * fastest(s, *before) / diameter);
}

void ArrivalCheck::overlaps(std::span<const Particle> particles, std::span<const char> is_new,
                            const std::function<bool(std::int64_t)>& is_clump,
                            std::int64_t interval) const {
  std::vector<Ball> balls;
  balls.reserve(particles.size());
  for (std::size_t i = 0; i < particles.size(); ++i) {
    const auto& [s, shape] = particles[i];
    if (is_clump(s.id)) continue;
    balls.push_back({s.id, s.x, shape.radius, is_new[i] != 0, carrier_of(shape)});
  }
  if (const auto pair = find_overlap(balls, fluid_))
    refuse(
        "interval {}: {}; the centre of one lies in the other: correct their places or diameters",
        interval, describe(*pair));
}

}  // namespace protocol
