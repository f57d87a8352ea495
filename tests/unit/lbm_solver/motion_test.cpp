// SPDX-License-Identifier: GPL-2.0-or-later
/// Motions that a scene gives to its obstacles: poses, cells, words for the script, bad input.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "lbm_solver/base/errors.h"
#include "lbm_solver/base/mass_moments.h"
#include "lbm_solver/base/mesh_cut.h"
#include "lbm_solver/coupling/handshake.h"
#include "lbm_solver/coupling/inner_fluid.h"
#include "lbm_solver/coupling/motion_words.h"
#include "lbm_solver/immersed/moving_shape.h"
#include "lbm_solver/io/scene_reader.h"
#include "lbm_solver/io/script_variables.h"
#include "lbm_solver/io/stl_file.h"
#include "lbm_solver/solver/plan.h"
#include "tests/support/job.h"
#include "tests/support/meshes.h"

namespace {

using namespace lbm;
using std::numbers::pi;

class Motions : public testing::Test {
 protected:
  /// A box of 20 × 20 (× 20) mm in cells of 1 mm with an obstacle; a second.
  std::string scene(int dimension, const std::string& obstacle) const {
    const bool flat = dimension == 2;
    return folder_.write("scene.toml",
                         std::string("[box]\nsize = ") +
                             (flat ? "[0.02, 0.02]" : "[0.02, 0.02, 0.02]") +
                             "\n[fluid]\ndensity = 1000.0\nkinematic_viscosity = 1e-5\n"
                             "velocity_scale = 0.02\n[numerics]\ncell = 0.001\n"
                             "[run]\nend_time = 1.0\n" +
                             extra_ + "[[obstacle]]\n" + obstacle);
  }
  Scene read(int dimension, const std::string& obstacle) const {
    return read_scene({scene(dimension, obstacle)});
  }
  void refused(int dimension, const std::string& obstacle,
               const std::vector<std::string>& words) const {
    try {
      make_plan(read(dimension, obstacle));
      ADD_FAILURE() << "accepted: " << obstacle;
    } catch (const InputError& e) {
      for (const std::string& word : words)
        EXPECT_NE(std::string(e.what()).find(word), std::string::npos)
            << word << " not in: " << e.what();
    }
  }
  void warned(int dimension, const std::string& obstacle, const std::string& words) const {
    std::string all;
    for (const std::string& w : make_plan(read(dimension, obstacle)).warnings) all += w + "\n";
    if (words.empty())
      EXPECT_EQ(all, "");
    else
      EXPECT_NE(all.find(words), std::string::npos) << words << " not in: " << all;
  }
  test::TemporaryFolder folder_;
  std::string extra_;
};

const std::string kDisc = "centre = [0.01, 0.008]\ndiameter = 0.006\n";
const std::string kBlock = "from = [0.008, 0.008]\nto = [0.012, 0.0105]\n";
const std::string kBox = "from = [0.008, 0.008, 0.007]\nto = [0.012, 0.0105, 0.011]\n";

// Velocities are the changes of places in time.
TEST_F(Motions, HaveTheVelocitiesOfTheirPlaces) {
  folder_.write("way.csv", "time,x,y,z,angle\n0,0,0,0,0\n0.4,0.001,0.002,0,0.3\n1,0,0.001,0,1\n");
  for (const std::string motion :
       {"motion = \"linear\"\nvelocity = [0.002, -0.001, 0.003]",
        "motion = \"rotation\"\naxis = [1, 2, 2]\nangular_velocity = -3\nabout = [0.01, 0.01, 0.0]",
        "motion = \"oscillation\"\namplitude = [0.001, 0, 0.002]\nfrequency = 2\naxis = [0, 0, 3]\n"
        "angular_amplitude = 0.2",
        "motion = \"table\"\nmotion_table = \"way.csv\"\naxis = [0, 1, 0]"}) {
    const MotionScene m = *read(3, kBox + motion).obstacles[0].motion;
    const double h = 1e-6;
    for (const double t : {0.1, 0.3, 0.77}) {
      const Vec3 corner(0.011, 0.009, 0.008), at = pose_at(m, t).moved(corner);
      const Vec3 slope =
          (pose_at(m, t + h).moved(corner) - pose_at(m, t - h).moved(corner)) / (2.0 * h);
      EXPECT_LT((slope - pose_at(m, t).velocity_at(at)).norm(), 1e-7) << motion << " at " << t;
    }
    EXPECT_LT((pose_at(m, 0.0).moved(m.about) - m.about).norm(), 1e-15) << motion;
  }
}

TEST_F(Motions, OfATableStayAtItsEnds) {
  folder_.write("way.csv", "time,x,y\n0.2,0.001,0\n0.4,0.001,0.002\n");
  const Scene s = read(2, kBlock + "motion = \"table\"\nmotion_table = \"way.csv\"");
  const MotionScene& m = *s.obstacles[0].motion;
  EXPECT_LT((pose_at(m, 0.0).shift - Vec3(0.001, 0.0)).norm(), 1e-15);
  EXPECT_LT((pose_at(m, 0.3).shift - Vec3(0.001, 0.001)).norm(), 1e-15);
  EXPECT_LT((pose_at(m, 2.0).shift - Vec3(0.001, 0.002)).norm(), 1e-15);
  EXPECT_EQ(pose_at(m, 2.0).velocity.norm(), 0.0);
  warned(2, kBlock + "motion = \"table\"\nmotion_table = \"way.csv\"",
         "the 1. obstacle has a motion_table that begins at 0.2 s: it stands until then");
  warned(2, kBlock + "motion = \"table\"\nmotion_table = \"way.csv\"",
         "ends at 0.4 s, the run at 1 s: it stands from then on");
  folder_.write("way.csv", "time,x,y\n0,0,0\n1e9,0.001,0\n");
  warned(2, kBlock + "motion = \"table\"\nmotion_table = \"way.csv\"", "are they in ns?");
}

TEST_F(Motions, ThatAreWrongAreNamed) {
  refused(2, kDisc + "motion = \"linear\"", {"obstacle.velocity"});
  refused(2, kDisc + "motion = \"linear\"\nvelocity = [0, 0]", {"obstacle.velocity is zero"});
  refused(2, kDisc + "motion = \"jumping\"", {"linear, rotation, oscillation, table"});
  refused(2, kDisc + "motion = \"rotation\"\nangular_velocity = 0", {"angular_velocity is zero"});
  refused(3, kBox + "motion = \"rotation\"\nangular_velocity = 1", {"obstacle.axis"});
  refused(3, kBox + "motion = \"rotation\"\nangular_velocity = 1\naxis = [0, 0, 0]",
          {"axis is zero"});
  refused(2, kDisc + "spin = 1.0\nmotion = \"rotation\"\nangular_velocity = 1",
          {"spin stands beside motion"});
  refused(2, kDisc + "motion = \"oscillation\"\nfrequency = 1",
          {"amplitude is missing or 0", "angular_amplitude"});
  refused(2, kDisc + "velocity = [0.1, 0.0]",
          {"obstacle.motion is missing beside velocity", "give motion = \"linear\""});
  refused(3, kBox + "angular_velocity = 1\naxis = [0, 0, 1]",
          {"motion is missing beside angular_velocity", "give motion = \"rotation\""});
  refused(2, kDisc + "motion = \"linear\"\nvelocity = [1.0, 0.0]",
          {"the 1. obstacle's motion makes 1 m/s", "a run stops at 0.2"});
  refused(2, kDisc + "motion = \"rotation\"\nangular_velocity = 100.0\nabout = [0.0, 0.0]",
          {"the 1. obstacle's motion"});
  refused(2, kDisc + "motion = \"oscillation\"\namplitude = [1e-6, 0]\nfrequency = 1000",
          {"obstacle.frequency = 1000 Hz has", "fluid steps a period"});
}

TEST_F(Motions, OfAHollowMeshAreRefused) {
  write_stl(folder_.path() + "/mesh.stl",
            test::box_mesh({0.004, 0.004, 0.004}, {0.016, 0.016, 0.016}));
  refused(3, "mesh = \"mesh.stl\"\nhollow = true\nmotion = \"linear\"\nvelocity = [0.001, 0, 0]",
          {"hollow stands beside motion", "of one surface with a thickness"});
}

TEST_F(Motions, ThatHardlyAreMeantAreNamed) {
  warned(2, kDisc + "motion = \"linear\"\nvelocity = [0.01, 0.0]", "");
  warned(2, kDisc + "motion = \"linear\"\nvelocity = [0.018, 0.0]", "has left the box at 0.7");
  warned(2, kDisc + "motion = \"linear\"\nvelocity = [0.005, 0.0]\nsurface_only = true",
         "moves its surface only, which does not move along itself");
  warned(2, kDisc + "motion = \"rotation\"\nangular_velocity = 2\nsurface_only = true", "");
  warned(2, kDisc + "hollow = true\nmotion = \"rotation\"\nangular_velocity = 2",
         "the 1. obstacle is a drum, whose wall of 10 cells reaches the sides of the box");
  warned(2, kBlock + "motion = \"rotation\"\nangular_velocity = 2\nsurface_only = true",
         "fluid would pass through; leave surface_only out");
}

TEST_F(Motions, OfBadTablesAreNamedWithTheirLine) {
  const std::string key = kDisc + "motion = \"table\"\nmotion_table = \"way.csv\"";
  refused(2, kDisc + "motion = \"table\"", {"motion_table is missing"});
  refused(2, key, {"way.csv", "put a table time,x,y,angle beside the scene"});
  const auto table = [&](const std::string& text, const std::string& words) {
    folder_.write("way.csv", text);
    refused(2, key, {"motion_table", words});
  };
  table("t,x\n", "begins with 't,x'");
  table("time,x,y\n0,0,0\n", "fewer than two lines");
  table("time,x,y\n0,0,0\n1,0\n", "line 3: '1,0' is not 3 finite numbers");
  table("time,x,y\n0,0,0\n1,0,nan\n", "line 3");
  table("time,x,y\n0,0,0\n1,0,0 x\n", "line 3");
  table("time,x,y\n1,0,0\n1,0,0\n", "line 3: time 1 s does not come after 1 s");
}

/// Sums of the fractions of a shape's cells, its core counted as one; and of their first moments.
struct Cells {
  double volume = 0.0;
  Vec3 moment;
  std::size_t core = 0;
};
Cells cells_of(const MovingShape& shape, const Domain& box, const Block& cells,
               std::vector<double>& map) {
  Cells sums;
  shape.map(box, cells, [&](const CoverSpan& span) {
    for (std::size_t k = 0; k < span.cover.size(); ++k) {
      const double eps = fraction_of(span.cover[k]);
      const Cell3 c{span.x + static_cast<int>(k) + cells.begin[0], span.y + cells.begin[1],
                    span.z + cells.begin[2]};
      sums.volume += eps;
      sums.moment += eps * Vec3(c[0] + 0.5, c[1] + 0.5, c[2] + 0.5);
      sums.core += span.cover[k] == kCore;
      double& at = map[(static_cast<std::size_t>(c[2]) * box.ny + c[1]) * box.nx + c[0]];
      at += span.cover[k];
    }
  });
  return sums;
}

// Wherever it is, it covers its volume about its place, and every rank maps its own part of that.
TEST_F(Motions, OfAMeshCoverWhatTheyShould) {
  const Domain box{30, 28, Side::Periodic, Side::Wall, 26, Side::Wall};
  MovingShape shape(
      {std::make_shared<const TriangleMesh>(test::box_mesh({8.0, 9.0, 7.0}, {19.0, 17.0, 18.0})),
       false},
      {});
  for (const int step : {0, 3, 11, 40}) {
    Pose pose;
    pose.pivot = {13.5, 13.0, 12.5};
    pose.axis = Vec3(2, 1, 2) / 3.0;
    pose.angle = 0.11 * step;
    pose.shift = {0.51 * step, 0.013 * step, -0.02 * step};  // across the periodic side
    shape.look(pose);
    std::vector<double> whole(box.nx * box.ny * box.nz), parts(whole.size());
    const Cells sums = cells_of(shape, box, Block::whole(box), whole);
    EXPECT_NEAR(sums.volume, 11.0 * 8.0 * 11.0, 1e-6) << step;
    const Vec3 way = sums.moment / sums.volume - pose.centre();
    EXPECT_LT(std::abs(way.y()), 0.02) << step;  // kSnap, and places within a cell
    EXPECT_LT(std::abs(way.z()), 0.02) << step;
    EXPECT_GT(sums.core, 50U) << step;
    for (const int cut : {0, 1}) {
      Block part = Block::whole(box);
      part.begin[0] = cut == 0 ? 0 : 13;
      part.size[0] = cut == 0 ? 13 : 17;
      cells_of(shape, box, part, parts);
    }
    for (std::size_t k = 0; k < whole.size(); ++k) ASSERT_NEAR(parts[k], whole[k], 1e-9) << k;
  }
}

// A box that turns about a corner, by hand: ρ V a of its middle, and no torque about the corner
// where it turns steadily.
TEST_F(Motions, TakeTheFluidInsideAlong) {
  const Scene s = read(2, kBlock +
                              "motion = \"rotation\"\nangular_velocity = 2.0\n"
                              "about = [0.008, 0.008]");
  const Plan plan = make_plan(s);
  const BodyLoad inner = InnerFluid(plan, s.obstacles[0]).in_step(0);
  const double w = 2.0 * plan.units.dt, area = 4.0 * 2.5;
  // the change of a step lies half of its angle behind
  EXPECT_NEAR(inner.force.x(), -area * w * w * 2.0, w * area * w * w);
  EXPECT_NEAR(inner.force.y(), -area * w * w * 1.25, 1.1 * w * area * w * w);
  EXPECT_NEAR(inner.torque.z(), 0.0, 1e-12);
  const Scene rocking = read(2, kDisc +
                                    "motion = \"oscillation\"\nangular_amplitude = 0.5\n"
                                    "frequency = 1.0");
  const Plan other = make_plan(rocking);
  const auto quarter = static_cast<std::int64_t>(0.25 / other.units.dt);
  const BodyLoad turned = InnerFluid(other, rocking.obstacles[0]).in_step(quarter);
  const double alpha = -std::pow(2.0 * pi * other.units.dt, 2) * 0.5;
  EXPECT_NEAR(turned.torque.z() / (0.5 * pi * 81.0 * alpha), 1.0, 1e-3);
}

TEST_F(Motions, ReachAScriptAsWords) {
  const auto words = [&](const std::string& motion) {
    return mesh_motion_words(*read(3, kBox + motion).obstacles[0].motion);
  };
  EXPECT_EQ(words("motion = \"linear\"\nvelocity = [0.001, 0, -0.002]"), "linear 0.001 0 -0.002");
  EXPECT_EQ(words("motion = \"rotation\"\naxis = [0, 0, 2]\nangular_velocity = -6.283185307179586"
                  "\nabout = [0.01, 0.01, 0]"),
            "rotate origin 0.01 0.01 0 axis -0 -0 -1 period 1");
  EXPECT_EQ(words("motion = \"oscillation\"\namplitude = [0, 0.001, 0]\nfrequency = 4"),
            "wiggle amplitude 0 0.001 0 period 0.25");
  const std::string rocking = words(
      "motion = \"oscillation\"\naxis = [1, 0, 0]\nabout = [0, 0, 0]\nfrequency = 4\n"
      "angular_amplitude = 1.5707963267948966");
  EXPECT_EQ(rocking, "riggle origin 0 0 0 axis 1 0 0 period 0.25 amplitude 90");
  EXPECT_EQ(words("motion = \"linear\"\nvelocity = [0.001, 0, 0]\nsurface_only = true"),
            "surface_vel 0.001 0 0");
}

TEST_F(Motions, ThatTheSolidCannotFollowAreRefusedInACoupledScene) {
  extra_ = "[particles]\ndiameter = 0.002\ndensity = 2000.0\n[coupling]\n";
  folder_.write("way.csv", "time,x,y\n0,0,0\n2,0.002,0.002\n");
  const std::string table = "motion = \"table\"\nmotion_table = \"way.csv\"";
  refused(2, kBlock + table,
          {"moves as a table says", "cannot follow: grains and fluid would meet two walls"});
  refused(2,
          kBlock +
              "motion = \"oscillation\"\namplitude = [0.001, 0]\nangular_amplitude = 0.1\n"
              "frequency = 1",
          {"to and fro and about an axis at once"});
  make_plan(read(2, kDisc + table));  // a disc is no mesh of the script
  const auto has = [&](const std::string& obstacle, const std::string& name) {
    EXPECT_TRUE(is_reserved_variable(name));
    const Scene s = read(2, obstacle);
    for (const auto& v : make_handshake(s, make_plan(s)).variables)
      if (v.name == name) return v.value;
    return std::string("none");
  };
  EXPECT_EQ(has(kBlock + "motion = \"linear\"\nvelocity = [0.001, 0]", "mesh1_motion"),
            "linear 0.001 0 0");
  // rad/s, so that a grain of 1 mm has the wall's speed where it touches: 2 × 3/(3 - 1)
  EXPECT_EQ(has(kDisc + "hollow = true\nmotion = \"rotation\"\nangular_velocity = 2", "disc1_wall"),
            "zcylinder 0.003 0.01 0.008 shear x 3");
}

const std::string kWide = "from = [0.007, 0.008]\nto = [0.012, 0.0125]\n";

// What LIGGGHTS would stop at, without a word of why.
TEST_F(Motions, ThatLeaveTheBoxOfTheSolidAreNamed) {
  extra_ = "[particles]\ndiameter = 0.002\ndensity = 2000.0\n[coupling]\n";
  const auto said = [&](int dimension, const std::string& obstacle) {
    std::string all;
    for (const std::string& w : make_plan(read(dimension, obstacle)).warnings) all += w + "\n";
    return all.find("reaches through") == std::string::npos ? "" : all;
  };
  EXPECT_EQ(said(2, kWide + "motion = \"rotation\"\nangular_velocity = 0.5\n"), "");
  warned(2, kWide + "motion = \"linear\"\nvelocity = [-0.01, 0]",
         "the 1. obstacle reaches through the wall \"left\" at 0.70");
  warned(2, kWide + "motion = \"linear\"\nvelocity = [0, 0.01]",
         "reaches through the wall \"top\" at 0.75");
  warned(3, kBox + "motion = \"linear\"\nvelocity = [0, 0, -0.0099]",
         "\"left the domain\"), and grains between the two are crushed");
}

TEST_F(Motions, OfABlockInAThinLayerAreOfferedInShortPieces) {
  extra_ = "[particles]\ndiameter = 0.002\ndensity = 2000.0\n[coupling]\n";
  const std::string text =
      test::read_file(scene(2, kWide + "motion = \"rotation\"\nangular_velocity = 0.5\n"));
  const auto with_depth = [&](const std::string& depth) {
    return read_scene({folder_.write(
        "scene.toml", test::replaced(text, "[fluid]", "depth = " + depth + "\n[fluid]"))});
  };
  const auto too_thin = [](const Scene& s) {
    std::string all;
    for (const std::string& w : make_plan(s).warnings)
      if (w.find("is too thin for the 1. obstacle") != std::string::npos) all += w;
    return all;
  };
  for (const char* depth : {"0.02", "0.005", "0.002"}) {
    const Scene s = with_depth(depth);
    EXPECT_EQ(too_thin(s), "") << depth;
    write_meshes(s, folder_.path());
    const TriangleMesh offered = read_stl(folder_.path() + "/mesh1.stl");
    const auto [low, high] = bounds(offered);
    EXPECT_LT(largest_reach(offered) + 0.6 * 0.002, s.box.depth) << depth;
    EXPECT_LT((Vec3(low.x(), low.y()) - s.obstacles[0].from).norm(), 1e-12);
    EXPECT_LT((Vec3(high.x(), high.y()) - s.obstacles[0].to).norm(), 1e-12);
    bool ends = false;                         // across z, as where the layer is thick
    for (const auto& t : offered.triangles) {  // they face outwards
      const Vec3 middle =
          (offered.vertices[t[0]] + offered.vertices[t[1]] + offered.vertices[t[2]]) / 3.0;
      EXPECT_GT(offered.area_vector(t).dot(middle - 0.5 * (low + high)), 0.0);
      ends = ends || offered.area_vector(t).z() != 0.0;
    }
    EXPECT_EQ(ends, std::string(depth) == "0.02") << depth;
  }
  EXPECT_NE(too_thin(with_depth("0.0015")).find("take a depth of at least 0.002 m"),
            std::string::npos);
}

// What stands beyond the box is cut off for the solid, in a coupled scene; the fluid keeps it.
TEST_F(Motions, AreNoneOfWhatIsCutAtTheBox) {
  const std::string rod =
      "from = [-0.005, 0.01, 0.01]\nto = [0.03, 0.012, 0.01]\ndiameter = 0.004\n";
  extra_ = "[particles]\ndiameter = 0.002\ndensity = 2000.0\n[coupling]\n";
  const Scene s = read(3, rod);
  write_meshes(s, folder_.path());
  const TriangleMesh cut = read_stl(folder_.path() + "/mesh1.stl");
  const auto [low, high] = bounds(cut);
  EXPECT_EQ(low.x(), 0.0);
  EXPECT_EQ(high.x(), 0.02);
  double area = 0.0;
  for (const auto& t : cut.triangles) area += 0.5 * cut.area_vector(t).norm();
  // of the sides of the rod without its ends; ends across x: 1/cos longer there
  const double slant = std::hypot(1.0, 0.002 / 0.035);
  EXPECT_NEAR(area / (pi * 0.004 * 0.02 * slant), 1.0, 1e-3);
  extra_ = "";
  const Scene alone = read(3, rod);
  write_meshes(alone, folder_.path());
  EXPECT_LT(bounds(read_stl(folder_.path() + "/mesh1.stl"))[0].x(), -0.004);
}

}  // namespace
