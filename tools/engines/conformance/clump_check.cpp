// SPDX-License-Identifier: MIT
#include "tools/engines/conformance/clump_check.h"

#include <fmt/format.h>

#include <cmath>

#include "protocol/wire/clumps.h"

namespace conformance {

using namespace protocol;

namespace {

using Particles = std::vector<Particle>;

/// Twice the area of a triangle, of vectors in the plane.
double cross(const Vec3& a, const Vec3& b) {
  return a[0] * b[1] - a[1] * b[0];
}
Vec3 between(const Vec3& a, const Vec3& b) {
  return {b[0] - a[0], b[1] - a[1], 0.0};
}

/// A clump and its discs, in this order.
Particles expect_clump(const Particles& now, const Scene& scene, int interval) {
  Particles all;
  for (const Particle& p : now)
    if (!is_part(p.shape)) all.push_back(p);
  expect(all.size() == 1 && now.size() == 3,
         fmt::format("interval {}: {} of {} records are no parts of a clump; the scene's one clump "
                     "is a carrier and two discs that name it (an engine without clumps cannot)",
                     interval, all.size(), now.size()));
  const Shape& body = all[0].shape;
  for (const Particle& p : now)
    if (is_part(p.shape)) {
      expect(p.shape.carrier == body.id, "a disc names another carrier than the one that is there");
      expect_near(p.shape.radius, kRadius, 1e-9 * kRadius, "radius of a disc of the clump");
      all.push_back(p);
    }
  // The quadrature of engines may be another one; a volume that is sampled is off by 1e-3.
  const UnionMoments whole = scene.clump();
  const double mass = scene.density * whole.volume;
  const double inertia = mass * (whole.second[0] + whole.second[1]);
  expect_near(body.mass, mass, 2e-3 * mass, "mass of the union");
  expect_near(body.volume, whole.volume, 2e-3 * whole.volume, "volume of the union");
  expect_near(body.inertia, inertia, 2e-3 * inertia, "inertia of the union");
  return all;
}

/// The motion of a rigid body: each disc at its distance, with the velocity v + ω × r.
void expect_rigid(const Particles& clump) {
  const State& body = clump[0].state;
  for (std::size_t i = 1; i < clump.size(); ++i) {
    const State& disc = clump[i].state;
    const Vec3 arm = between(body.x, disc.x);
    expect_near(std::hypot(arm[0], arm[1]), kClump[1][0], 1e-9, "distance of a disc of the clump");
    expect_near(disc.v[0], body.v[0] - body.omega[2] * arm[1], 1e-9, "speed x of its disc");
    expect_near(disc.v[1], body.v[1] + body.omega[2] * arm[0], 1e-9, "speed y of its disc");
  }
}

/// Impulse and angular impulse are exact; the way may be that of a scheme of the first order, whose
/// error of ten equal steps is a twentieth of what the load adds.
void expect_clump_moves(const Particles& before, const Particles& now, const Load& load) {
  const State &a = before[0].state, &b = now[0].state;
  const Shape& body = now[0].shape;
  for (int k = 0; k < 2; ++k) {
    const double gained = load.force[k] / body.mass * kInterval;
    expect_near(b.v[k] - a.v[k], gained, 1e-9 * std::abs(gained) + 1e-12,
                "speed that a clump gains in an interval");
    expect_near(b.x[k] - a.x[k], 0.5 * (a.v[k] + b.v[k]) * kInterval,
                0.06 * std::abs(gained) * kInterval + 1e-12, "way of a clump");
  }
  const double gained = load.torque[2] / body.inertia * kInterval;
  expect_near(b.omega[2] - a.omega[2], gained, 1e-9 * std::abs(gained),
              "spin that a clump gains in an interval");
  const Vec3 arm = between(a.x, before[1].state.x), later = between(b.x, now[1].state.x);
  expect_near(
      std::asin(cross(arm, later) / std::hypot(arm[0], arm[1]) / std::hypot(later[0], later[1])),
      0.5 * (a.omega[2] + b.omega[2]) * kInterval, 0.06 * std::abs(gained) * kInterval + 1e-9,
      "angle by which a clump turns");
}

}  // namespace

void clump(Judge& judge) {
  const Scene scene{.clumps = true};
  const auto on_carrier = [](int k, const Particle& p) {
    return is_part(p.shape) ? nothing(k, p) : pushed(k, p);
  };
  Particles before;
  judge.converse(judge.hello(scene), 12, on_carrier, [&](int k, const Particles& now) {
    const Particles found = expect_clump(now, scene, k);
    expect_rigid(found);
    if (k > 0) expect_clump_moves(before, found, pushed(k - 1, before[0]));
    before = found;
  });
}

}  // namespace conformance
