// SPDX-License-Identifier: MIT
/// What a solid program of any kind may not send, seen by the fluid: each is named with both values
/// and the interval that it came with. The solid here speaks the wire without a session's help.
#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <functional>
#include <future>
#include <random>

#include "protocol/transport/memory_channel.h"
#include "protocol/wire/ball_union.h"
#include "protocol/wire/overlap.h"
#include "protocol/wire/session.h"
#include "tests/unit/protocol/samples.h"

namespace {

using namespace protocol;

const Wait kWait{20.0, "the other side"};
constexpr double kRadius = 0.00125, kMass = 6.135923e-3, kInertia = 4.8e-9;

Shape shape(std::int64_t id) {
  return {id, kRadius, kMass, kInertia, 1};
}
State state(std::int64_t id, double x, double y = 0.03) {
  State s;
  s.id = id;
  s.x = {x, y, 0.0};
  return s;
}

/// One particle at interval 0, told.
StateBatch first() {
  const Hello hello = test::sample_hello(Role::Solid);
  return {{0, 0.0, kContinue},
          {hello.step, hello.box_lo, hello.box_hi},
          {state(5, 0.01)},
          {shape(5)},
          {}};
}
/// The next interval, nothing new.
StateBatch next() {
  StateBatch batch = first();
  batch.head.interval = 1;
  batch.shapes.clear();
  return batch;
}

struct Seen {
  std::string refusal;  ///< empty where nothing was refused
  int exit_code = 0;
  std::vector<Arrival> arrivals;
};

/// The fluid takes the batches of a solid that has agreed.
Seen arrive(const std::vector<StateBatch>& batches,
            const std::function<void(Hello&)>& change_fluid = {}) {
  MemoryLink link = make_memory_link(1, 1);
  Hello fluid = test::sample_hello(Role::Fluid);
  if (change_fluid) change_fluid(fluid);
  Hello solid = fluid;
  solid.role = Role::Solid;
  solid.step = 2e-5;
  solid.particles = 0;
  Channel& c = *link.solid[0];
  c.send(0, encode(solid), kWait);
  c.send(0, encode(Answer{}), kWait);
  for (const StateBatch& batch : batches) c.send(0, encode(batch), kWait);
  Seen seen;
  FluidSession session(*link.fluid[0], fluid, 20.0);
  try {
    session.agree();
    for (std::size_t k = 0; k < batches.size(); ++k) {
      const Arrival& arrival = session.receive();
      seen.arrivals.push_back(arrival);
      std::vector<Load> loads;
      for (const Particle& p : arrival.particles) loads.push_back({p.state.id, {}, {}});
      session.answer(loads);
    }
  } catch (const BadMessage& refused) {
    seen.refusal = refused.what();
    seen.exit_code = refused.exit_code();
  }
  return seen;
}

void expect_refusal(const Seen& seen, const std::vector<std::string>& words, std::size_t after,
                    int exit_code = kBadInput) {
  EXPECT_EQ(seen.exit_code, exit_code) << seen.refusal;
  EXPECT_EQ(seen.arrivals.size(), after) << "not at the exchange that it came with";
  for (const auto& word : words)
    EXPECT_NE(seen.refusal.find(word), std::string::npos) << word << " not in: " << seen.refusal;
  EXPECT_EQ(seen.refusal.find("velocity_scale"), std::string::npos) << seen.refusal;
}

TEST(Arrival, OfWhatWasAgreedIsTaken) {
  StateBatch moved = next();
  moved.states[0].x[0] += kRadius;
  const Seen seen = arrive({first(), moved});
  EXPECT_EQ(seen.refusal, "");
  EXPECT_EQ(seen.arrivals.size(), 2U);
}

struct Change {
  const char* name;
  std::function<void(StateBatch&)> change;
  std::vector<std::string> words;
  int exit_code = kBadInput;
};
void PrintTo(const Change& c, std::ostream* out) {
  *out << c.name;
}

/// Wrong in the second exchange.
class LaterChange : public testing::TestWithParam<Change> {};

TEST_P(LaterChange, IsNamedAtTheExchangeThatItCameWith) {
  StateBatch bad = next();
  GetParam().change(bad);
  expect_refusal(arrive({first(), bad}), GetParam().words, 1, GetParam().exit_code);
}

std::vector<Change> later_changes() {
  return {
      {"step", [](StateBatch& b) { b.setting.step *= 2.0; }, {"interval 1", "4e-05 s", "2e-05 s"}},
      {"step_nan", [](StateBatch& b) { b.setting.step = std::nan(""); }, {"time step is nan"}},
      {"box",
       [](StateBatch& b) { b.setting.box_hi[1] = 0.054; },
       {"box y", "0 … 0.054 m", "0 … 0.06 m"}},
      {"depth", [](StateBatch& b) { b.setting.box_hi[2] = 0.25; }, {"box z", "0.25"}},
      {"outside",
       [](StateBatch& b) { b.states[0].x[0] = 5.0; },
       {"particle 5", "lies 4.98 m outside of the box at interval 1"}},
      {"jump",
       [](StateBatch& b) { b.states[0].x[1] += 20 * kRadius; },
       {"particle 5 jumped", "in interval 1", "10 diameters"}},
      {"not_finite",
       [](StateBatch& b) { b.states[0].omega[2] = INFINITY; },
       {"particle 5: angular velocity", "interval 1: not finite"},
       kNumerics},
      {"out_of_the_plane",
       [](StateBatch& b) { b.states[0].v[2] = 0.1; },
       {"particle 5 leaves the plane at interval 1: velocity (0, 0, 0.1) m/s", "enforce2d"}},
      {"turns_out_of_the_plane",
       [](StateBatch& b) { b.states[0].omega[1] = -3.0; },
       {"particle 5 leaves the plane", "angular velocity (0, -3, 0)"}},
      {"twice_as_large",
       [](StateBatch& b) {
         b.shapes = {{5, 1.5 * kRadius, 2.25 * kMass, 4 * kInertia, 1}};
       },
       {"particle 5", "diameter 0.00375 m at interval 1", "0.0025 … 0.0025 m"}},
      {"denser",
       [](StateBatch& b) {
         b.shapes = {{5, kRadius, 2 * kMass, kInertia, 1}};
       },
       {"particle 5", "density 2500", "1250 … 1250"}},
      {"inertia",
       [](StateBatch& b) {
         b.shapes = {{5, kRadius, kMass, 10 * kInertia, 1}};
       },
       {"particle 5", "inertia 4.8e-08"}},
      {"volume",
       [](StateBatch& b) {
         b.shapes = {shape(5)};
         b.shapes[0].volume = 1e-6;
       },
       {"particle 5", "volume 1e-06"}},
      {"clump",
       [](StateBatch& b) {
         b.shapes = {shape(5)};
         b.shapes[0].carrier = 1;
       },
       {"particle 5 is a sphere of clump 1", "has a mass of 0.006135923 kg", "says 0"}},
      {"sphere_alone",
       [](StateBatch& b) {
         b.shapes = {{5, kRadius, 0.0, 0.0, 1, 0, 1}};
       },
       {"particle 5 is a sphere of clump 1, which did not come with it at interval 1"}},
      {"type",
       [](StateBatch& b) {
         b.shapes = {shape(5)};
         b.shapes[0].type = 0;
       },
       {"particle 5: type 0"}},
      {"shape_of_another",
       [](StateBatch& b) { b.shapes = {shape(6)}; },
       {"a shape of particle 6 came at interval 1, but no state"}},
      {"two_shapes",
       [](StateBatch& b) { b.shapes.assign(2, shape(5)); },
       {"two shapes of particle 5"}},
      {"late_and_small",
       [](StateBatch& b) {
         b.states.push_back(state(6, 0.015));
         b.shapes = {{6, 0.0002, kMass, kInertia, 1}};
       },
       {"particle 6", "diameter 0.0004 m", "0.0025"}},
      {"late_and_in_the_same_place",
       [](StateBatch& b) {
         b.states.push_back(state(6, 0.0105));
         b.shapes = {shape(6)};
       },
       {"interval 1", "particles 5 and 6 overlap", "0.0005 m apart"}},
  };
}
INSTANTIATE_TEST_SUITE_P(Arrival, LaterChange, testing::ValuesIn(later_changes()),
                         [](const auto& info) { return std::string(info.param.name); });

// ---- clumps -------------------------------------------------------------------------------------

/// Two discs of a clump, 1.5 radii apart, with the ids 6 and 7; the clump is 9.
StateBatch clump() {
  constexpr double half = 0.75 * kRadius;
  StateBatch b = first();
  b.states = {state(6, 0.01 - half), state(7, 0.01 + half), state(9, 0.01)};
  const Ball balls[] = {{6, {-half, 0.0, 0.0}, kRadius}, {7, {half, 0.0, 0.0}, kRadius}};
  const Hello hello = test::sample_hello(Role::Fluid);
  const double volume = moments_of_union(balls, 2, hello.depth).volume, mass = 1250.0 * volume;
  b.shapes = {{6, kRadius, 0.0, 0.0, 1, 0, 9},
              {7, kRadius, 0.0, 0.0, 1, 0, 9},
              {9, kRadius + half, mass, mass * kRadius * kRadius, 1, 0, kItself, volume}};
  return b;
}

TEST(Arrival, AClumpComesWithSpheresThatOverlap) {
  const Seen seen = arrive({clump()});
  EXPECT_EQ(seen.refusal, "");
  ASSERT_EQ(seen.arrivals.size(), 1U);
  EXPECT_EQ(seen.arrivals[0].particles.size(), 3U);
}

struct ClumpFault {
  const char* name;
  std::function<void(StateBatch&)> change;
  std::vector<std::string> words;
};

TEST(Arrival, WhatIsWrongWithAClumpIsNamed) {
  const ClumpFault faults[] = {
      {"volume once a sphere",
       [](StateBatch& b) { b.shapes[2].volume *= 1.3, b.shapes[2].mass *= 1.3; },
       {"clump 9: volume", "at interval 0 at (0.01, ", "its 2 spheres fill", "ntry"}},
      {"no volume",
       [](StateBatch& b) { b.shapes[2].volume = 0.0; },
       {"clump 9: volume 0 m³", "union of its spheres"}},
      {"density",
       [](StateBatch& b) { b.shapes[2].mass *= 2.0; },
       {"clump 9: density 2500 kg/m³", "1250 … 1250"}},
      {"sphere too far",
       [](StateBatch& b) { b.states[1].x[1] += kRadius; },
       {"clump 9: its sphere 7 reaches", "its radius is"}},
      {"chain",
       [](StateBatch& b) { b.shapes[1].carrier = 6; },
       {"particle 7 is a sphere of clump 6, which is a sphere of clump 9 itself"}},
      {"sphere of another size",
       [](StateBatch& b) { b.shapes[0].radius *= 0.5; },
       {"particle 6: diameter", "particles.diameter"}},
      {"another particle in it",
       [](StateBatch& b) {
         b.states.insert(b.states.begin(), state(5, 0.01 + kRadius));
         b.shapes.insert(b.shapes.begin(), shape(5));
       },
       {"particles", "overlap", "5"}},
  };
  for (const ClumpFault& fault : faults) {
    StateBatch batch = clump();
    fault.change(batch);
    SCOPED_TRACE(fault.name);
    expect_refusal(arrive({batch}), fault.words, 0);
  }
}

TEST(Arrival, AClumpThatComesApartIsNamed) {
  StateBatch later = clump(), apart = clump();
  later.head.interval = apart.head.interval = 1;
  later.shapes.clear();
  EXPECT_EQ(arrive({clump(), later}).refusal, "");
  StateBatch bent = later;
  bent.states[1].x[1] += 0.8 * kRadius;
  expect_refusal(arrive({clump(), bent}), {"clump 9: its sphere 7 reaches", "interval 1"}, 1);
  apart.states.erase(apart.states.begin(), apart.states.begin() + 2);
  apart.shapes.clear();
  expect_refusal(arrive({clump(), apart}), {"clump 9 came without its spheres at interval 1"}, 1);
}

TEST(Arrival, ARadiusLargerThanTheBoxIsNamed) {
  StateBatch huge = first();
  huge.shapes = {{5, 0.03, 1.0, 1e-5, 1}};
  const auto no_ranges = [](Hello& fluid) {
    fluid.radius.reset();
    fluid.density.reset();
  };
  expect_refusal(arrive({huge}, no_ranges), {"particle 5", "radius 0.03 m", "larger than the box"},
                 0);
}

TEST(Arrival, ARadiusMayGrowButNotJump) {
  const auto wide = [](Hello& fluid) { fluid.radius = Range{0.001, 0.003}; };
  StateBatch grown = next(), jumped = next();
  grown.shapes = {{5, 1.05 * kRadius, 1.05 * 1.05 * kMass, kInertia, 1}};
  jumped.shapes = {{5, 2.0 * kRadius, 4.0 * kMass, kInertia, 1}};
  EXPECT_EQ(arrive({first(), grown}, wide).refusal, "");
  expect_refusal(arrive({first(), jumped}, wide), {"radius 0.0025 m at interval 1", "0.00125 m"},
                 1);
  jumped.shapes[0].epoch = 1;  // another particle: any size that was agreed
  EXPECT_EQ(arrive({first(), jumped}, wide).refusal, "");
}

TEST(Arrival, AnotherEpochMayBeAnywhere) {
  StateBatch elsewhere = next();
  elsewhere.states[0].x[1] = 0.055;
  elsewhere.shapes = {shape(5)};
  expect_refusal(arrive({first(), elsewhere}), {"particle 5 jumped"}, 1);
  elsewhere.shapes[0].epoch = 1;
  EXPECT_EQ(arrive({first(), elsewhere}).refusal, "");
}

TEST(Arrival, AFastParticleAndAPeriodicSideAreNoJump) {
  const auto tall = [](Hello& fluid) { fluid.periodic[1] = 1; };
  StateBatch across = next();
  across.states[0].x[1] -= 0.06;  // an image of its place
  EXPECT_EQ(arrive({first(), across}, tall).refusal, "");
  StateBatch fast = next();
  fast.states[0].x[1] += 0.02;
  fast.states[0].v[1] = 110.0;  // 0.022 m an interval of 2e-4 s
  EXPECT_EQ(arrive({first(), fast}).refusal, "");
}

TEST(Arrival, AParticleThatLeavesAnOpenSideMayTouchTheFluidFromOutside) {
  StateBatch leaving = first();
  leaving.states[0].x[0] = -0.9 * kRadius;
  EXPECT_EQ(arrive({leaving}).refusal, "");
}

/// A pair in any order of ids.
std::vector<std::int64_t> ids(const std::optional<Overlap>& pair) {
  std::vector<std::int64_t> ids;
  if (pair) ids = {pair->first.id, pair->second.id};
  std::sort(ids.begin(), ids.end());
  return ids;
}

// 100 000 at one place, and 100 000 side by side of sizes 1 to 30: bounded by the number, not by
// its square (1e10 pairs would take a minute; the two take 0.3 s here).
TEST(OverlapSearch, IsBoundedWhateverLiesWhere) {
  Hello box;
  box.dimension = 3;
  box.box_hi = {1.0, 1.0, 1.0};
  std::vector<Ball> one_place(100000, Ball{0, {0.5, 0.5, 0.5}, 1e-3});
  for (std::size_t i = 0; i < one_place.size(); ++i) one_place[i].id = static_cast<int>(i);
  EXPECT_EQ(ids(find_overlap(one_place, box)), (std::vector<std::int64_t>{0, 1}));

  std::vector<Ball> apart;
  const int n = 46;
  for (int i = 0; i < n * n * n; ++i)
    apart.push_back({i,
                     {(i % n + 0.5) / n, (i / n % n + 0.5) / n, (i / n / n + 0.5) / n},
                     0.4 / n / (1 + i % 30)});
  EXPECT_FALSE(find_overlap(apart, box));
}

// Against the search of all pairs, random balls in a periodic box, in two and three dimensions.
TEST(OverlapSearch, FindsAPairWhereThereIsOne) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  int with = 0, without = 0;
  for (int trial = 0; trial < 400; ++trial) {
    Hello box;
    box.dimension = 2 + trial % 2;
    box.box_hi = {1.0, 0.7, 0.5};
    box.periodic = {static_cast<std::uint8_t>(trial / 2 % 2), 1, 0};
    std::vector<Ball> balls;
    for (int i = 0; i < 12; ++i)
      balls.push_back({i,
                       {unit(random), 0.7 * unit(random), 0.5 * unit(random)},
                       0.15 * std::pow(unit(random), 3) + 1e-3,
                       unit(random) < 0.5});
    bool found = false;
    for (const Ball& a : balls)
      for (const Ball& b : balls) {
        double squares = 0.0;
        for (unsigned k = 0; k < box.dimension; ++k) {
          double d = a.x[k] - b.x[k];
          if (box.periodic[k]) d = std::remainder(d, box.box_hi[k]);
          squares += d * d;
        }
        if (a.id < b.id && (a.is_new || b.is_new) &&
            std::sqrt(squares) < std::max(a.radius, b.radius))
          found = true;
      }
    EXPECT_EQ(find_overlap(balls, box).has_value(), found) << "trial " << trial;
    (found ? with : without)++;
  }
  EXPECT_GT(with, 50);
  EXPECT_GT(without, 50);
}

}  // namespace
