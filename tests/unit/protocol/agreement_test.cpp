// SPDX-License-Identifier: MIT
#include "protocol/wire/agreement.h"

#include <gtest/gtest.h>

#include <functional>

#include "tests/unit/protocol/samples.h"

namespace {

using namespace protocol;

struct Mismatch {
  const char* word;  ///< that the complaint must contain
  std::function<void(Hello&)> change;
};

const std::vector<Mismatch>& mismatches() {
  static const std::vector<Mismatch> all{
      {"box x", [](Hello& h) { h.box_hi[0] = 0.0201; }},
      {"box y", [](Hello& h) { h.box_lo[1] = -0.01; }},
      {"boundary x", [](Hello& h) { h.periodic[0] = 1; }},
      {"depth", [](Hello& h) { h.depth = 0.5; }},
      {"dimension", [](Hello& h) { h.dimension = 3; }},
      {"gravity", [](Hello& h) { h.gravity[1] = -9.81; }},
      {"buoyancy", [](Hello& h) { h.buoyancy = Buoyancy::BySolid; }},
      {"coupling interval", [](Hello& h) { h.step *= 1.001; }},
      {"substeps", [](Hello& h) { h.solid_steps = 9; }},
      {"first coupling interval", [](Hello& h) { h.first_interval = 3; }},
      {"radius",
       [](Hello& h) {
         h.radius = Range{0.001, 0.00125};
       }},
      {"density",
       [](Hello& h) {
         h.density = Range{1250.0, 2500.0};
       }},
      {"schedule: fluid serial, solid overlapped",
       [](Hello& h) { h.schedule = Schedule::Overlapped; }},
      {"units", [](Hello& h) { h.units = "lj"; }},
  };
  return all;
}

TEST(Agreement, AcceptsTheSameScene) {
  EXPECT_TRUE(
      disagreements(test::sample_hello(Role::Fluid), test::sample_hello(Role::Solid)).empty());
}

TEST(Agreement, AcceptsRoundOffOfADecimalText) {
  Hello solid = test::sample_hello(Role::Solid);
  solid.step *= 1.0 + 1e-12;
  solid.box_hi[0] *= 1.0 - 1e-12;
  EXPECT_TRUE(disagreements(test::sample_hello(Role::Fluid), solid).empty());
}

TEST(Agreement, ASolidMayBeAbleToDoMoreThanIsNeeded) {
  Hello fluid = test::sample_hello(Role::Fluid), solid = test::sample_hello(Role::Solid);
  solid.features = kCheckpoints;
  EXPECT_TRUE(disagreements(fluid, solid).empty());
  std::swap(fluid.features, solid.features);
  ASSERT_EQ(disagreements(fluid, solid).size(), 1U);
  EXPECT_NE(disagreements(fluid, solid)[0].find("cannot write any"), std::string::npos);
  fluid.features = 4;
  EXPECT_NE(disagreements(fluid, solid)[0].find("features"), std::string::npos);
}

TEST(Agreement, NamesEachMismatch) {
  for (const auto& m : mismatches()) {
    Hello solid = test::sample_hello(Role::Solid);
    m.change(solid);
    const auto found = disagreements(test::sample_hello(Role::Fluid), solid);
    ASSERT_FALSE(found.empty()) << m.word;
    bool named = false;
    for (const auto& reason : found) named = named || reason.find(m.word) != std::string::npos;
    EXPECT_TRUE(named) << m.word << " not in: " << found.front();
  }
}

TEST(Agreement, ListsEveryDisagreementAtOnce) {
  Hello solid = test::sample_hello(Role::Solid);
  for (const char* word : {"box x", "depth", "gravity", "substeps"})
    for (const auto& m : mismatches())
      if (std::string(m.word) == word) m.change(solid);
  EXPECT_GE(disagreements(test::sample_hello(Role::Fluid), solid).size(), 4U);
}

TEST(Agreement, AnEmptyBoxHasNoRadiusToDisagreeAbout) {
  Hello solid = test::sample_hello(Role::Solid);
  solid.particles = 0;
  solid.radius.reset();
  solid.density.reset();
  EXPECT_TRUE(disagreements(test::sample_hello(Role::Fluid), solid).empty());
}

}  // namespace
