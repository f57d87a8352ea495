// SPDX-License-Identifier: GPL-2.0-or-later
/// The bond law alone, against what can be derived by hand.
#include "liggghts_coupling/bond/bond_law.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "liggghts_coupling/bond/time_step_limits.h"

namespace {

using namespace dem;

const BondLaw kBond{2e5, 1e5, 30.0, 20.0};
const ContactLaw kContact{1e5, 1.0, 5e4, 0.5, 0.0};

PairMotion at(double overlap, double normal_velocity = 0.0, double shear_velocity = 0.0,
              double step = 1e-5) {
  PairMotion m;
  m.overlap = overlap;
  m.normal = {1.0, 0.0, 0.0};
  m.normal_velocity = normal_velocity;
  m.tangential_velocity = {0.0, shear_velocity, 0.0};
  m.effective_mass = 0.1;
  m.step = step;
  return m;
}

TEST(BondLaw, PullsUntilItsTensileStrength) {
  PairMemory memory;
  make_bond(memory, kContact, kBond, 0.0);
  EXPECT_DOUBLE_EQ(respond(memory, kContact, kBond, at(-1e-4), true).normal, -20.0);
  EXPECT_DOUBLE_EQ(respond(memory, kContact, kBond, at(1e-4), true).normal, 20.0);
  const PairResponse r = respond(memory, kContact, kBond, at(-1.50001e-4), true);
  EXPECT_EQ(r.broken, Break::Tension);
  EXPECT_EQ(r.normal, 0.0);
  EXPECT_EQ(r.tangential[1], 0.0);
  EXPECT_NEAR(r.energy.released, 30.0 * 30.0 / (2.0 * 2e5), 1e-7);  // F²/2k
  EXPECT_FALSE(memory.bonded);
  EXPECT_FALSE(respond(memory, kContact, kBond, at(-1e-5), true).force);  // nothing pulls any more
}

TEST(BondLaw, StartsWithTheForceOfTheContact) {
  for (const double exponent : {1.0, 1.5}) {
    ContactLaw contact = kContact;
    contact.exponent = exponent;
    PairMemory memory;
    const double before = respond(memory, contact, kBond, at(2e-4), true).normal;
    make_bond(memory, contact, kBond, 2e-4);
    EXPECT_NEAR(respond(memory, contact, kBond, at(2e-4), true).normal, before, 1e-12);
  }
}

TEST(BondLaw, ShearBreakKeepsTheContactForce) {
  PairMemory memory;
  make_bond(memory, kContact, kBond, 1e-3);  // 100 N
  PairResponse r;
  int steps = 0;
  for (; r.broken == Break::None && steps < 1000; ++steps)
    r = respond(memory, kContact, kBond, at(1e-3, 0.0, 0.5), true);
  EXPECT_EQ(r.broken, Break::Shear);
  EXPECT_EQ(steps, 40);                       // 20 N / (1e5 N/m · 0.5 m/s · 1e-5 s)
  EXPECT_NEAR(r.tangential[1], -20.0, 1e-9);  // below μF_n = 50 N, so it stays
  EXPECT_NEAR(r.normal, 100.0, 1e-9);         // contact law at the same overlap
  for (int k = 0; k < 1000; ++k) r = respond(memory, kContact, kBond, at(1e-3, 0.0, 0.5), true);
  EXPECT_NEAR(r.tangential[1], -50.0, 1e-9);  // now Coulomb's
}

TEST(BondLaw, ShearBreakAcrossAGapEndsAllForces) {
  PairMemory memory;
  make_bond(memory, kContact, kBond, -1e-4);
  PairResponse r;
  while (r.broken == Break::None) r = respond(memory, kContact, kBond, at(-1e-4, 0.0, 0.5), true);
  EXPECT_EQ(r.broken, Break::Shear);
  EXPECT_FALSE(r.force);
  EXPECT_EQ(r.normal, 0.0);
}

TEST(BondLaw, ASecondLookMovesNothingOn) {
  PairMemory memory;
  make_bond(memory, kContact, kBond, 0.0);
  respond(memory, kContact, kBond, at(0.0, 0.0, 0.1), true);
  const PairMemory before = memory;
  const PairResponse once = respond(memory, kContact, kBond, at(-2e-4, 0.0, 0.1), false);
  EXPECT_EQ(once.broken, Break::Tension);
  EXPECT_TRUE(memory.bonded);
  EXPECT_EQ(memory.shear_force, before.shear_force);
}

TEST(BondLaw, ShearForceTurnsWithTheContactPlane) {
  PairMemory memory;
  make_bond(memory, kContact, kBond, 0.0);
  for (int k = 0; k < 10; ++k) respond(memory, kContact, kBond, at(0.0, 0.0, 0.5), true);
  const double before = std::abs(memory.shear_force[1]);
  PairMotion turned = at(0.0);
  turned.normal = {std::cos(0.3), std::sin(0.3), 0.0};
  const PairResponse r = respond(memory, kContact, kBond, turned, true);
  EXPECT_NEAR(r.tangential[0] * turned.normal[0] + r.tangential[1] * turned.normal[1], 0.0, 1e-12);
  EXPECT_NEAR(std::hypot(r.tangential[0], r.tangential[1]), before, 1e-12);
}

/// Two equal bodies on a line, velocity Verlet, until they part.
struct Impact {
  double restitution, duration;
};
Impact impact(const ContactLaw& law, double mass, double speed, double step) {
  double gap = 0.0, v = -speed, t = 0.0, force = 0.0;
  PairMemory memory;
  do {
    v += 0.5 * step * force / (0.5 * mass);
    gap += step * v;
    PairMotion m = at(-gap, v, 0.0, step);
    m.effective_mass = 0.5 * mass;
    force = respond(memory, law, kBond, m, true).normal;
    v += 0.5 * step * force / (0.5 * mass);
    t += step;
  } while (gap < 0.0);
  return {v / speed, t};
}

TEST(ContactLaw, RestitutionOfASpringAndDashpot) {
  for (const double ratio : {0.02, 0.1, 0.5}) {  // e = 0.163 at ξ = 0.5
    ContactLaw law = kContact;
    law.damping_ratio = ratio;
    const double exact = std::exp(-std::numbers::pi * ratio / std::sqrt(1.0 - ratio * ratio));
    EXPECT_NEAR(impact(law, 0.2, 0.1, 1e-7).restitution / exact, 1.0, 0.01) << ratio;
  }
}

TEST(ContactLaw, DurationOfAHertzImpact) {
  // t_c = 2.868 (m*²/(R* E*² v))^{1/5} with K = 4/3 E* √R*: 3.214 (m*/K)^{2/5} v^{-1/5}
  ContactLaw law = kContact;
  law.exponent = 1.5;
  law.normal_stiffness = 1e8;
  const double mass = 0.1, speed = 0.2;
  const double exact = 2.868 * std::pow(4.0 / 3.0, 0.4) *
                       std::pow(mass / law.normal_stiffness, 0.4) * std::pow(speed, -0.2);
  const Impact result = impact(law, 2.0 * mass, speed, 1e-8);
  EXPECT_NEAR(result.duration / exact, 1.0, 0.002);
  EXPECT_NEAR(result.restitution, 1.0, 1e-4);
}

/// A body slides on a plane under its weight. @param inertia  over mR²: ½ a disc, 0.4 a sphere,
/// 0: it does not turn
struct Slide {
  double distance, velocity;
};
Slide slide(double start, double inertia, double seconds) {
  const double mass = 1.0, radius = 0.01, g = 9.81, step = 1e-6;
  const ContactLaw law{1e6, 1.0, 5e5, 0.3, 0.2};
  double y = mass * g / law.normal_stiffness, vy = 0.0, x = 0.0, vx = start, spin = 0.0;
  PairMemory memory;
  for (double t = 0.0; t < seconds; t += step) {
    PairMotion m;
    m.overlap = y;
    m.normal = {0.0, 1.0, 0.0};
    m.normal_velocity = vy;
    m.tangential_velocity = {vx + spin * radius, 0.0, 0.0};  // spin > 0: counter-clockwise
    m.effective_mass = mass;
    m.step = step;
    const PairResponse r = respond(memory, law, kBond, m, true);
    vx += step * r.tangential[0] / mass;
    vy += step * (r.normal / mass - g);
    if (inertia > 0.0) spin += step * r.tangential[0] / (inertia * mass * radius);
    x += step * vx;
    y -= step * vy;
  }
  return {x, vx};
}

TEST(ContactLaw, SlidingStopsAfterVSquaredOverTwoMuG) {
  EXPECT_NEAR(slide(0.5, 0.0, 0.3).distance / (0.25 / (2.0 * 0.3 * 9.81)), 1.0, 0.01);
}

TEST(ContactLaw, ABodyRollsWithItsPartOfTheSpeed) {
  EXPECT_NEAR(slide(0.5, 0.5, 0.2).velocity / 0.5, 2.0 / 3.0, 0.005);  // disc
  EXPECT_NEAR(slide(0.5, 0.4, 0.2).velocity / 0.5, 5.0 / 7.0, 0.005);  // sphere
}

TEST(BondLaw, EnergyIsAccountedFor) {
  // A pair that oscillates, shears until it breaks, slides and parts: start = all parts, 1 %.
  for (const double tension : {1e9, 12.0}) {
    const BondLaw bond{2e5, 1e5, tension, 15.0};
    const ContactLaw contact{1e5, 1.0, 5e4, 0.5, 0.05};
    const double mass = 0.2, step = 1e-7;  // of the relative motion: m/2
    PairMemory memory;
    make_bond(memory, contact, bond, 1e-4);
    double overlap = 1e-4, vn = 0.35, vt = 0.4;
    const double start =
        0.25 * mass * (vn * vn + vt * vt) + 0.5 * 10.0 * 10.0 / bond.normal_stiffness;
    EnergyFlow sum;
    for (int k = 0; k < 400000; ++k) {
      PairMotion m = at(overlap, vn, vt, step);
      m.effective_mass = 0.5 * mass;
      const PairResponse r = respond(memory, contact, bond, m, true);
      vn += step * r.normal / (0.5 * mass);
      vt += step * r.tangential[1] / (0.5 * mass);
      overlap -= step * vn;
      sum.elastic = r.energy.elastic;
      sum.friction += r.energy.friction;
      sum.damping += r.energy.damping;
      sum.released += r.energy.released;
      sum.stiffness_change += r.energy.stiffness_change;
    }
    const double end = 0.25 * mass * (vn * vn + vt * vt) + sum.elastic + sum.friction +
                       sum.damping + sum.released + sum.stiffness_change;
    EXPECT_NEAR(end / start, 1.0, 0.01) << tension;
    EXPECT_FALSE(memory.bonded);
  }
}

BondLaw parallel_bond(double tensile = 1e9, double shear = 1e9, bool three_dimensional = false) {
  return {2e5, 1e5, tensile, shear, BondSection::of(0.01, three_dimensional)};
}

TEST(BondLaw, CarriesNoMomentSoThatAChainFoldsFreely) {
  PairMemory memory;
  make_bond(memory, kContact, kBond, 0.0);
  PairMotion m = at(0.0);
  m.turning = {0.0, 0.0, 50.0};  // one rolls on the other: no slip at the contact point
  for (int k = 0; k < 100; ++k) {
    const PairResponse r = respond(memory, kContact, kBond, m, true);
    EXPECT_EQ(r.moment[2], 0.0);
    EXPECT_EQ(r.normal, 0.0);
    EXPECT_EQ(r.tangential[1], 0.0);
  }
}

TEST(ParallelBond, BendsWithItsSecondMoment) {
  PairMemory memory;
  make_bond(memory, kContact, parallel_bond(), 0.0);
  PairMotion m = at(0.0);
  m.turning = {0.0, 0.0, 2.0};
  PairResponse r;
  for (int k = 0; k < 100; ++k) r = respond(memory, kContact, parallel_bond(), m, true);
  // K_n^b I/A θ: 2e5 · 1e-4/3 · 2e-3 rad; no force, and all of it stored
  EXPECT_NEAR(r.moment[2], -2e5 * 1e-4 / 3.0 * 2e-3, 1e-12);
  EXPECT_EQ(r.normal, 0.0);
  EXPECT_NEAR(r.energy.elastic, 0.5 * 2e5 * 1e-4 / 3.0 * 4e-6, 1e-15);
}

TEST(ParallelBond, TwistsInThreeDimensions) {
  PairMemory memory;
  const BondLaw bond = parallel_bond(1e9, 1e9, true);
  make_bond(memory, kContact, bond, 0.0);
  PairMotion m = at(0.0);
  m.turning = {3.0, 0.0, 0.0};  // about the axis
  PairResponse r;
  for (int k = 0; k < 100; ++k) r = respond(memory, kContact, bond, m, true);
  EXPECT_NEAR(r.moment[0], -2.0 * 1e5 * 1e-4 / 4.0 * 3e-3, 1e-12);  // 2 K_t^b I/A θ
}

TEST(ParallelBond, BreaksAtItsMostStretchedFibre) {
  // M R̄A/I = F_bn: θ = F_bn/(K_n^b R̄) = 6/(2e5 · 0.01) = 3e-3 rad = 150 steps of 2e-5
  const BondLaw bond = parallel_bond(6.0);
  PairMemory memory;
  make_bond(memory, kContact, bond, 0.0);
  PairMotion m = at(0.0);
  m.turning = {0.0, 0.0, 2.0};
  PairResponse r;
  int steps = 0;
  for (; r.broken == Break::None && steps < 1000; ++steps)
    r = respond(memory, kContact, bond, m, true);
  EXPECT_EQ(r.broken, Break::Tension);
  EXPECT_NEAR(steps, 150, 1);
  EXPECT_EQ(memory.moment[2], 0.0);
  EXPECT_NEAR(r.energy.released, 0.5 * 2e5 * 1e-4 / 3.0 * 9e-6, 1e-6);
}

TEST(StrengthFactor, IsTheSameInAnyOrderAndSpreadEvenly) {
  double sum = 0.0, lo = 2.0, hi = 0.0;
  for (long k = 0; k < 10000; ++k) {
    const double f = strength_factor(k, 3 * k + 7, 0.2, 42);
    EXPECT_EQ(f, strength_factor(3 * k + 7, k, 0.2, 42));
    sum += f;
    lo = std::min(lo, f);
    hi = std::max(hi, f);
  }
  EXPECT_NEAR(sum / 10000, 1.0, 0.005);
  EXPECT_GE(lo, 0.8);
  EXPECT_LE(hi, 1.2);
  EXPECT_LT(lo, 0.801);
  EXPECT_GT(hi, 1.199);
  EXPECT_EQ(strength_factor(1, 2, 0.0, 42), 1.0);
}

TEST(TimeStepLimits, AreThePapersFormulas) {
  StepCase c{"", 4.0, 0.02, 0.1, 100.0, 50.0, 0.75, false};
  const auto limits = step_limits(c);
  ASSERT_EQ(limits.size(), 6U);
  EXPECT_DOUBLE_EQ(limits[0].step, 0.4);                              // 2√(m/k)
  EXPECT_DOUBLE_EQ(limits[1].step, 0.2);                              // √(m/k)
  EXPECT_DOUBLE_EQ(limits[2].step, std::sqrt(0.02 / (50.0 * 0.01)));  // √(I/K_tR²)
  EXPECT_DOUBLE_EQ(limits[3].step, 0.06);                             // 0.3 √(m/k)
  EXPECT_DOUBLE_EQ(limits[4].step, 0.2);                              // √(1+ξ²) - ξ = ½
  EXPECT_DOUBLE_EQ(limits[5].step, 0.1);
  // paper A, Table I: R = 0.98 mm, ρ = 3000, k = 5e7 N/m, ξ = 0.5, λ = 0.1 give its 8.333e-7 s
  const double mass = 3000.0 * std::numbers::pi * 0.98e-3 * 0.98e-3;
  c = {"", mass, 0.5 * mass * 0.98e-3 * 0.98e-3, 0.98e-3, 5e7, 0.0, 0.5, false};
  EXPECT_NEAR(0.1 * step_limits(c)[5].step / 8.333e-7, 1.0, 0.01);
  EXPECT_NEAR(rayleigh_limit(1e-3, 2500.0, 1e9, 0.25) * 1e6,
              std::numbers::pi * 1e-3 / 0.917375 * std::sqrt(2.5e-6) * 1e6, 1e-9);
}

}  // namespace
