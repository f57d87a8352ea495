// SPDX-License-Identifier: MIT
#include "protocol/wire/walls.h"

#include <gtest/gtest.h>

#include "tests/unit/protocol/samples.h"

namespace {

using namespace protocol;

struct Scene {
  Hello fluid = test::sample_hello(Role::Fluid), solid = test::sample_hello(Role::Solid);
  Scene() {
    fluid.bodies.clear();
    solid.bodies.clear();
  }
  std::vector<std::string> found() const { return one_sided_walls(fluid, solid); }
};

void expect_one(const std::vector<std::string>& found, const std::string& words) {
  ASSERT_EQ(found.size(), 1U);
  EXPECT_NE(found[0].find(words), std::string::npos) << found[0];
}

TEST(Walls, ThatBothHaveAreNotNamed) {
  EXPECT_TRUE(Scene().found().empty());
}

TEST(Walls, OfTheFluidAloneAreNamedWithTheirPlace) {
  Scene scene;
  (*scene.solid.sides)[2] = SideWall::None;
  expect_one(scene.found(), "side bottom (y = 0 m) is a wall for the fluid, no plane wall");
  (*scene.fluid.sides)[2] = SideWall::Partly;
  expect_one(scene.found(), "side bottom (y = 0 m) is a wall for the fluid");
}

TEST(Walls, OfTheParticlesAloneAreNamed) {
  Scene scene;
  (*scene.fluid.sides)[3] = SideWall::None;
  expect_one(scene.found(), "side top (y = 0.06 m) is a wall for the particles and open");
}

TEST(Walls, ThatAreNoSidesAreNamed) {
  Scene scene;
  scene.solid.bodies = {"fix drum mesh/surface"};
  expect_one(scene.found(), "fix drum mesh/surface is a wall for the particles only");
  scene.solid.bodies.clear();
  scene.fluid.bodies = {"3 obstacles"};
  expect_one(scene.found(), "3 obstacles: there for the fluid only");
  scene.solid.bodies = {"fix pipe wall/gran (cylinder)"};
  EXPECT_EQ(scene.found().size(), 1U);  // may be the same place: only that of the solid is named
}

TEST(Walls, OfASideThatDoesNotSayAreNotGuessed) {
  Scene scene;
  scene.solid.sides.reset();
  EXPECT_TRUE(scene.found().empty());
}

}  // namespace
