// SPDX-License-Identifier: GPL-2.0-or-later
#include "lbm_solver/solver/scene_check.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "lbm_solver/base/errors.h"

namespace lbm {
namespace {

constexpr double kLightest = 0.1;                   // density of a particle over the fluid's
constexpr double kDeepRest = 0.05, kDeepHit = 1.0;  // overlap over radius that goes unremarked
constexpr double kManyBytes = 20e9;                 // of fields
constexpr double kThick = 0.1;                      // m²/s: more than any honey

std::string place_text(const Scene& s, const Vec3& x) {
  return s.box.dimension == 2 ? fmt::format("[{:.6g}, {:.6g}]", x.x(), x.y())
                              : fmt::format("[{:.6g}, {:.6g}, {:.6g}]", x.x(), x.y(), x.z());
}

void check_particles(const Scene& s) {
  const ParticleScene& p = *s.particles;
  if (s.coupling && p.density.lo < kLightest * s.fluid.density)
    throw InputError(fmt::format("{}: particles.density = {:.6g} kg/m³ is below {} of the fluid's: "
                                 "the coupling is not proven stable there",
                                 s.file, p.density.lo, kLightest),
                     fmt::format("take at least {:.6g} kg/m³", kLightest * s.fluid.density));
  const double width = s.box.size.head(s.box.dimension).minCoeff();
  if (p.diameter.hi > width)
    throw InputError(
        fmt::format("{}: particles.diameter = {:.6g} m is wider than the box ({:.6g} m)", s.file,
                    p.diameter.hi, width),
        "take a smaller particle or a larger box");
  const auto half_periodic = [&](SideKind side, double length) {
    return side == SideKind::Periodic && p.diameter.hi > 0.5 * length;
  };
  for (int k = 0; k < s.box.dimension; ++k)
    if (half_periodic(s.box.sides[k], s.box.size[k]))
      throw InputError(
          fmt::format("{}: particles.diameter = {:.6g} m exceeds half of a periodic length", s.file,
                      p.diameter.hi),
          "take a longer box");
}

/// Discs that the scene places: inside the box, none in another.
void check_starts(const Scene& s) {
  const ParticleScene& p = *s.particles;
  const double r = 0.5 * p.diameter.lo;
  const int d = s.box.dimension;
  for (std::size_t i = 0; i < p.start.size(); ++i) {
    const Vec3& x = p.start[i];
    for (int k = 0; k < d; ++k) {
      const double margin = s.box.sides[k] == SideKind::Wall ? r : 0.0;
      const double lo = s.box.origin[k] + margin, hi = s.box.origin[k] + s.box.size[k] - margin;
      if (x[k] < lo - 1e-12 || x[k] > hi + 1e-12)
        throw InputError(
            s.file + ": particles.start",
            fmt::format("{} with radius {:.6g} m lies outside the box", place_text(s, x), r),
            fmt::format("keep its centre within {:.6g} … {:.6g} m in {}", lo, hi, "xyz"[k]));
    }
    for (std::size_t j = 0; j < i; ++j) {
      Vec3 apart = x - p.start[j];
      for (int k = 0; k < d; ++k)
        if (s.box.sides[k] == SideKind::Periodic)
          apart[k] = std::remainder(apart[k], s.box.size[k]);
      if (const double distance = apart.norm(); distance < 2.0 * r * (1.0 - 1e-6))
        throw InputError(s.file + ": particles.start",
                         fmt::format("{} and {} overlap by {:.4g} m", place_text(s, p.start[j]),
                                     place_text(s, x), 2.0 * r - distance),
                         fmt::format("keep centres a diameter apart, {:.6g} m", 2.0 * r));
    }
  }
}

void check_obstacle(const Scene& s, const ObstacleScene& o) {
  if (!o.round) return;  // blocks are checked with their cells
  for (int k = 0; k < s.box.dimension; ++k) {
    const double lo = s.box.origin[k], hi = lo + s.box.size[k], r = 0.5 * o.diameter;
    if (o.centre[k] + r <= lo || o.centre[k] - r >= hi)
      throw InputError(s.file + ": obstacle",
                       fmt::format("{} with diameter {:.6g} m lies outside the box",
                                   place_text(s, o.centre), o.diameter),
                       fmt::format("the box is {:.6g} … {:.6g} m in {}", lo, hi, "xyz"[k]));
  }
}

/// Where a boundary lies along the side's k-th axis [m].
Range extent(const Scene& s, const BoundaryScene& b, int k) {
  int axis = axis_of(b.side) == 0 ? 1 : 0;
  if (k == 1) axis = axis_of(b.side) == 2 ? 1 : 2;
  const double lo = s.box.origin[axis];
  return {b.from[k].value_or(lo), b.to[k].value_or(lo + s.box.size[axis])};
}

void check_boundaries(const Scene& s) {
  for (std::size_t i = 0; i < s.boundaries.size(); ++i)
    for (std::size_t j = 0; j < i; ++j) {
      const BoundaryScene &a = s.boundaries[j], &b = s.boundaries[i];
      bool shared = a.side == b.side;
      for (int k = 0; k < s.box.dimension - 1; ++k) {
        const Range first = extent(s, a, k), second = extent(s, b, k);
        shared = shared && std::min(first.hi, second.hi) > std::max(first.lo, second.lo);
      }
      if (shared)
        throw InputError(
            s.file + ": boundary",
            fmt::format("the {}. and the {}. lie on the same part of a side", j + 1, i + 1),
            "part them with from and to, or leave one out");
    }
}

/// Largest speed that the scene itself gives [m/s], and to what.
std::pair<double, std::string> given_speed(const Scene& s) {
  const bool layers = s.initial.kind == InitialScene::Kind::ShearLayer;  // a wave lies across
  const double across = layers ? s.initial.perturbation : 0.0;
  std::pair<double, std::string> largest{s.initial.velocity.norm() * std::hypot(1.0, across),
                                         "initial.velocity"};
  const auto look = [&](double speed, const std::string& what) {
    if (speed > largest.first) largest = {speed, what};
  };
  for (const BoundaryScene& b : s.boundaries) look(b.velocity.norm(), "boundary.velocity");
  for (const ObstacleScene& o : s.obstacles)
    look(0.5 * o.diameter * o.spin.norm(), "an obstacle's spin");
  return largest;
}

void check_speed(const Scene& s, Plan& plan) {
  const auto [speed, what] = given_speed(s);
  if (speed > kStopSpeed * plan.lattice_speed)
    throw InputError(
        fmt::format("{}: {} makes {:.4g} m/s, {:.3g} of C = Δx/Δt; a run stops at {}", s.file, what,
                    speed, speed / plan.lattice_speed, kStopSpeed),
        fmt::format("take velocity_scale = {:.4g}, the largest speed to expect", speed));
  if (speed > 1.001 * s.fluid.velocity_scale && speed > kWarnSpeed * plan.lattice_speed)
    plan.warnings.push_back(
        fmt::format("{} makes {:.4g} m/s, more than velocity_scale = {:.4g}: compressibility error",
                    what, speed, s.fluid.velocity_scale));
}

/// What the velocity boundaries bring in, less what they take out, over the sum of both.
double surplus(const Scene& s) {
  double sum = 0.0, all = 0.0;
  for (const BoundaryScene& b : s.boundaries) {
    double flow = b.velocity[axis_of(b.side)] * (is_high(b.side) ? -1.0 : 1.0);
    for (int k = 0; k < s.box.dimension - 1; ++k) {
      const Range part = extent(s, b, k);
      flow *= (part.hi - part.lo) * (b.parabolic ? 2.0 / 3.0 : 1.0);
    }
    sum += flow;
    all += std::abs(flow);
  }
  return all > 0.0 ? sum / all : 0.0;
}

void check_balance(const Scene& s, Plan& plan) {
  for (const BoundaryScene& b : s.boundaries)
    if (b.kind != BoundaryScene::Kind::Velocity || b.frequency > 0.0) return;
  if (const double more = surplus(s); std::abs(more) > 1e-3)
    plan.warnings.push_back(
        fmt::format("fluid {} through its boundaries and nothing makes up for it: the pressure {} "
                    "without end; add a boundary of kind \"outflow\" or \"pressure\"",
                    more > 0.0 ? "enters" : "leaves", more > 0.0 ? "rises" : "falls"));
}

void check_viscosity(const Scene& s, Plan& plan) {
  if (s.fluid.viscosity > kThick)
    plan.warnings.push_back(fmt::format(
        "fluid.kinematic_viscosity = {:.3g} m²/s is that of tar (water: 1e-6): is its unit right?",
        s.fluid.viscosity));
}

void check_contacts(const Scene& s, Plan& plan) {
  const ParticleScene& p = *s.particles;
  if (!p.contact_stiffness) return;
  const double r = 0.5 * p.diameter.hi, volume = particle_volume(s, p.diameter.hi);
  const double weight =
      std::max(0.0, p.density.hi - s.fluid.density) * volume * s.fluid.gravity.norm();
  // In parts of the radius: of one particle on another, and where one comes with velocity_scale.
  const double resting = weight / *p.contact_stiffness / r;
  const double hitting =
      s.fluid.velocity_scale * std::sqrt(p.density.hi * volume / *p.contact_stiffness) / r;
  if (resting > kDeepRest)
    plan.warnings.push_back(
        fmt::format("particles.contact_stiffness is soft: under its weight alone a particle sinks "
                    "into another by {:.3g} of its radius; {:.2g} N/m would keep that to {}",
                    resting, *p.contact_stiffness * resting / kDeepRest, kDeepRest));
  else if (hitting > kDeepHit)
    plan.warnings.push_back(
        fmt::format("particles.contact_stiffness is soft: a particle with velocity_scale goes "
                    "through another ({:.3g} of its radius); {:.2g} N/m would stop it at {}",
                    hitting, *p.contact_stiffness * hitting * hitting, kDeepHit));
}

void check_output(const Scene& s, Plan& plan) {
  if (s.output.fields_every == 0.0) return;
  const double frames = s.end_time / std::max(s.output.fields_every, plan.interval());
  constexpr double numbers = 5.0;  // velocity, pressure, solid fraction
  const double cells = static_cast<double>(plan.domain.nx) * plan.domain.ny * plan.domain.nz;
  if (const double bytes = frames * cells * numbers * sizeof(float); bytes > kManyBytes)
    plan.warnings.push_back(
        fmt::format("output.fields_every = {:.3g} s writes {:.3g} frames, {:.3g} GB before packing",
                    s.output.fields_every, frames, 1e-9 * bytes));
}

}  // namespace

void check_places(const Scene& s) {
  if (s.particles) {
    check_particles(s);
    check_starts(s);
  }
  for (const ObstacleScene& o : s.obstacles) check_obstacle(s, o);
  check_boundaries(s);
}

void check_meaning(const Scene& s, Plan& plan) {
  check_speed(s, plan);
  check_balance(s, plan);
  if (s.coupling) check_viscosity(s, plan);
  if (s.coupling) check_contacts(s, plan);
  check_output(s, plan);
}

}  // namespace lbm
