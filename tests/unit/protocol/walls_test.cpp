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

TEST(Walls, ThatAreOneMeshAreNotNamed) {
  const std::string screen = mesh_text({0.0, 0.0, 0.1}, {0.3, 0.2, 0.15});
  Scene scene;
  scene.fluid.bodies = {"obstacle: " + screen};
  scene.solid.bodies = {"fix screen mesh/surface (of fix walls wall/gran), " + screen};
  EXPECT_TRUE(scene.found().empty());
  const std::string other = mesh_text({0.0, 0.0, 0.2}, {0.3, 0.2, 0.25});
  scene.solid.bodies = {"fix screen mesh/surface (of fix walls wall/gran), " + other};
  expect_one(scene.found(), "fix screen mesh/surface (of fix walls wall/gran) is a wall for the");
  scene.solid.bodies.clear();
  expect_one(scene.found(), "obstacle: mesh from (0, 0, 0.1) to (0.3, 0.2, 0.15) m: there for the");
}

// One that moves is off by a step's way: a ten thousandth of the box is one place.
TEST(Walls, ThatAreOneMeshMayBeAStepApart) {
  Scene scene;
  const double size = scene.fluid.box_hi[1] - scene.fluid.box_lo[1];
  const auto mesh = [](double x) { return mesh_text({x, 0.0, 0.1}, {x + 0.3, 0.2, 0.15}); };
  scene.fluid.bodies = {"obstacle: " + mesh(0.0)};
  scene.solid.bodies = {"fix gate mesh/surface, " + mesh(0.5e-4 * size)};
  EXPECT_TRUE(scene.found().empty());
  scene.solid.bodies = {"fix gate mesh/surface, " + mesh(0.05 * size)};
  expect_one(scene.found(), "fix gate mesh/surface is a wall for the particles only");
}

TEST(Walls, ThatAreOneCylinderAreNotNamed) {
  Scene scene;
  scene.fluid.bodies = {"disc1 (cylinder)"};
  scene.solid.bodies = {"fix drum wall/gran (cylinder)"};
  EXPECT_TRUE(scene.found().empty());
  scene.fluid.bodies = {"the scene's obstacle"};
  expect_one(scene.found(), "fix drum wall/gran (cylinder) is a wall for the particles only");
}

// One mesh for both, which only one of them moves; an engine may not say.
TEST(Walls, ThatOnlyOneMovesAreNamed) {
  const std::string gate = mesh_text({0.0, 0.0, 0.1}, {0.3, 0.2, 0.15});
  const std::string other = mesh_text({0.0, 0.0, 0.2}, {0.3, 0.2, 0.25});
  Scene scene;
  scene.fluid.bodies = {"obstacle: " + other, "obstacle: " + gate + motion_text(true)};
  const auto solid_is = [&](const std::string& motion) {
    scene.solid.bodies = {"fix plate mesh/surface, " + other + motion_text(false),
                          "fix gate mesh/surface (of fix gates wall/gran), " + gate + motion};
  };
  solid_is(motion_text(true));
  EXPECT_TRUE(scene.found().empty());
  solid_is("");
  EXPECT_TRUE(scene.found().empty());
  solid_is(motion_text(false));
  expect_one(scene.found(),
             "fix gate mesh/surface (of fix gates wall/gran) stands still, and the obstacle of the "
             "scene at its place moves: grains and fluid will meet two walls; let the script move "
             "it, with fix ID all move/mesh mesh MESH ${mesh2_motion}");
  scene.fluid.bodies[1] = "obstacle: " + gate;
  EXPECT_TRUE(scene.found().empty());
  solid_is(motion_text(true));
  expect_one(scene.found(), "moves, and the obstacle of the scene at its place stands still");
  scene.fluid.bodies = {"disc1 (cylinder)"};
  scene.solid.bodies = {"fix drum wall/gran (cylinder)" + motion_text(true)};
  EXPECT_TRUE(scene.found().empty());
  scene.solid.bodies = {"fix drum wall/gran (cylinder)" + motion_text(false)};
  expect_one(scene.found(), "fix drum wall/gran (cylinder) stands still, and a disc of the scene");
}

TEST(Walls, OfASideThatDoesNotSayAreNotGuessed) {
  Scene scene;
  scene.solid.sides.reset();
  EXPECT_TRUE(scene.found().empty());
}

}  // namespace
