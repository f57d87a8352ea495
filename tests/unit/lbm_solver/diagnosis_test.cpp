// SPDX-License-Identifier: GPL-2.0-or-later
/// What a run that gets too fast says of the cause.
#include "lbm_solver/coupling/diagnosis.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "lbm_solver/io/scene_reader.h"
#include "protocol/wire/names.h"
#include "tests/unit/lbm_solver/scene_files.h"

namespace {

using namespace lbm;

/// The settling disc with one text in place of another, and what is said of two discs in it.
struct Situation {
  std::string from = "[run]", to = "[run]";
  std::vector<double> speeds{0.1, 0.11};  ///< of two looks, 50 steps apart
  std::optional<Vec3> at = Vec3(0.01, 0.03, 0.0);
  std::vector<std::array<double, 2>> discs;
  double time = 0.1;
  DeepStarts starts{};
};

std::string said(const Situation& now) {
  const test::TemporaryFolder folder;
  const Scene scene = read_scene(
      {folder.write("scene.toml", test::replaced(test::good_scene(), now.from, now.to))});
  SpeedRecord record;
  for (std::size_t i = 0; i < now.speeds.size(); ++i)
    record.add(50 * static_cast<std::int64_t>(i + 1), now.speeds[i]);
  std::vector<protocol::Particle> particles;
  for (const auto& [x, y] : now.discs) {
    protocol::Particle p{};
    p.state.id = p.shape.id = static_cast<std::int64_t>(particles.size() + 1);
    p.state.x = {x, y, 0.0};
    p.state.v = {0.0, 0.01 * static_cast<double>(particles.size()), 0.0};
    p.shape.radius = 1.25e-3;
    particles.push_back(p);
  }
  return diagnosis(scene, make_plan(scene), now.time, now.at, record, particles, now.starts);
}

void expect_says(const Situation& now, const std::vector<std::string>& words) {
  const std::string text = said(now);
  for (const std::string& word : words)
    EXPECT_NE(text.find(word), std::string::npos) << word << "\n" << text;
}

TEST(Diagnosis, OfDiscsThatOverlap) {
  expect_says({.at = Vec3(0.01, 0.0315, 0.0), .discs = {{0.01, 0.03}, {0.0101, 0.0281}}},
              {"The nearest is particle 1, 0.2 radii from there", "It overlaps particle 2 by 0.478",
               "start particles apart"});
  expect_says({.at = std::nullopt, .discs = {{0.01, 0.03}, {0.0101, 0.0281}}},
              {"It is particle 2.", "overlaps particle 1"});
}

// The disc's radius is 1.25 mm.
TEST(Diagnosis, OfADiscInAWallOrAnObstacle) {
  expect_says({.at = Vec3(0.001, 0.03, 0.0), .discs = {{0.0005, 0.03}}},
              {"It lies 0.6 of its radius deep in the wall \"left\".",
               "start particles outside of obstacles and walls"});
  const std::string block = "[[obstacle]]\nfrom = [0.005, 0.02]\nto = [0.015, 0.03]\n";
  expect_says({.to = block + "[run]", .at = Vec3(0.01, 0.031, 0.0), .discs = {{0.01, 0.03025}}},
              {"It lies 0.8 of its radius deep in the 1. obstacle.", "its contact throws it out"});
  const std::string moving = block + "motion = \"linear\"\nvelocity = [-0.04, 0.0]\n[run]";
  expect_says({.to = moving, .at = Vec3(0.001, 0.025, 0.0), .discs = {{0.001, 0.025}}},
              {"It lies 1 of its radius deep in the 1. obstacle (mesh of a block), which moves",
               "and 0.2 of its radius deep in the wall \"left\"", "it is crushed between the two"});
  expect_says({.to = moving, .at = Vec3(0.01, 0.025, 0.0), .discs = {{0.01, 0.025}}, .time = 0.0},
              {"5 of its radius deep", "(its centre is inside)", "what moves has run into it"});
  EXPECT_EQ(said({.to = moving, .at = Vec3(0.01, 0.0313, 0.0), .discs = {{0.01, 0.0313}}})
                .find("deep in"),
            std::string::npos);
}

// It lies in nothing any more when it is too fast.
TEST(Diagnosis, OfADiscThatWasThrownOut) {
  const DeepStarts starts{{1, "0.5 of its radius deep in the 1. obstacle"}};
  expect_says({.at = Vec3(0.01, 0.0315, 0.0), .discs = {{0.01, 0.03}}, .starts = starts},
              {"It began 0.5 of its radius deep in the 1. obstacle, and was thrown out.",
               "What to do: start it outside"});
  expect_says({.at = std::nullopt, .discs = {{0.01, 0.03}}, .starts = starts}, {"It began 0.5"});
  expect_says(
      {.starts = starts},
      {"Particle 1 began 0.5 of its radius deep in the 1. obstacle, was thrown out, and has "
       "left the box since. What to do: start it outside"});
  EXPECT_EQ(
      said({.at = Vec3(0.01, 0.04, 0.0), .discs = {{0.01, 0.03}}, .starts = starts}).find("began"),
      std::string::npos);
}

// A block of 10 x 10 mm that goes to the left at 40 mm/s; the second disc is a clump's.
TEST(Buried, AreThoseThatAMeshHasGoneOver) {
  const test::TemporaryFolder folder;
  const Scene scene = read_scene({folder.write(
      "scene.toml",
      test::replaced(test::good_scene(), "[run]",
                     "[[obstacle]]\nfrom = [0.005, 0.02]\nto = [0.015, 0.03]\nmotion = "
                     "\"linear\"\nvelocity = [-0.04, 0.0]\n[run]"))});
  std::vector<protocol::Particle> particles(2);
  for (std::int64_t i = 0; i < 2; ++i) {
    particles[i].state.id = particles[i].shape.id = i + 1;
    particles[i].state.x = {0.004 + 0.012 * static_cast<double>(i), 0.025, 0.0};
    particles[i].shape.radius = 1.25e-3;
  }
  particles[0].shape.carrier = protocol::clump_id(2, 7);
  EXPECT_EQ(buried_text(scene, particles, 0.0, {}), "");
  const std::string text = buried_text(scene, particles, 0.1, {});  // from 1 mm to 11 mm
  EXPECT_EQ(
      text.find("particle 1 (of clump 7 of the 2. fix rigid) lies 3.4 of its radius deep in "
                "the 1. obstacle (mesh of a block), which moves: what moves has gone over it"),
      0U)
      << text;
  EXPECT_EQ(buried_text(scene, particles, 0.1, {{1, "known"}}), "");
}

TEST(Diagnosis, OfAParticleThatIsTooFastByItself) {
  expect_says({.at = std::nullopt, .discs = {{0.01, 0.03}, {0.01, 0.04}}},
              {"It is particle 2.", "if this motion is right",
               "the velocity that the particle was given, and at its contacts"});
}

TEST(Diagnosis, OfADriveThatIsTooStrong) {
  expect_says({.from = "gravity = [0.0, -9.8]", .to = "body_force = [0.0, 50.0]"},
              {"fluid.body_force = 50 m/s² can give 1.41 m/s", "its value and unit"});
}

TEST(Diagnosis, OfAnInstability) {
  const std::vector<std::string> words{"factor 1.1 a step, which is an instability or a blow",
                                       "τ = ", "density of the particles over the fluid's 1.25"};
  expect_says({.speeds = {0.001, 0.1}, .discs = {{0.01, 0.031}}}, words);
  expect_says({.speeds = {0.001, std::numeric_limits<double>::infinity()}},
              {"factor 1.58 a step", "more cells"});
  EXPECT_EQ(said({.discs = {{0.01, 0.031}}}).find("instability"), std::string::npos);
}

TEST(Diagnosis, OfAFlowThatIsFasterThanItWasSaidToBe) {
  expect_says({}, {"it grew by a factor 1 a step.", "What drives most is fluid.gravity = 9.8 m/s²",
                   "if this flow is right, set fluid.velocity_scale"});
  expect_says({.speeds = {}}, {" What drives most"});
}

}  // namespace
