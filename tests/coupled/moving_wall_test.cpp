// SPDX-License-Identifier: GPL-2.0-or-later
/// A wall whose motion the scene gives, with the real programs: the fluid and LIGGGHTS have it in
/// the same place, and both go on from a checkpoint.
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <sstream>

#include "lbm_solver/io/scene_reader.h"
#include "tests/support/coupled_job.h"
#include "tests/support/script_parts.h"

namespace {

using namespace lbm;
using test::JobResult;
using test::mpirun;

/// A disc falls beside a block that moves, in two dimensions.
class MovingBlock : public testing::Test {
 protected:
  void write(const std::string& motion) {
    scene_file_ = folder_.write("scene.toml", R"(title = "moving_block"
[box]
size = [0.03, 0.03]
[fluid]
density = 1000.0
kinematic_viscosity = 1e-5
gravity = [0.0, -9.8]
velocity_scale = 0.1
[[obstacle]]
from = [0.0113, 0.0102]
to = [0.0164, 0.0131]
)" + motion + R"(
[particles]
diameter = 0.002
density = 1500.0
contact_stiffness = 500.0
start = [[0.0135, 0.0145]]
[numerics]
cell = 0.0005
[coupling]
[run]
end_time = 0.1
checkpoint_every = 0.02
[output]
probe_every = 0.01
)");
    folder_.write("in.liggghts", R"(
include ${scene_folder}/common/box.liggghts
if "${restart} == 0" then "create_atoms 1 single ${particle1_x} ${particle1_y} 0.0 units box"
if "${restart} == 0" then "set type 1 diameter ${diameter_max} density ${density_max}"
)" + test::linear_contacts("${contact_stiffness}", "10", "0.3") +
                                     test::box_walls(test::kLinear, "xy") +
                                     R"(fix block all mesh/surface file ${mesh1} type 1
fix blocks all wall/gran model hooke/stiffness tangential history mesh n_meshes 1 meshes block
fix turn all move/mesh mesh block ${mesh1_motion}
fix move all nve/sphere
fix weight all gravity ${gravity} vector ${gravity_x} ${gravity_y} 0.0
timestep ${solid_step}
fix fluid all lbm/couple every ${substeps}
fix flat all enforce2d
dump places all mesh/stl ${substeps}0 ${out_folder}/block*.stl
run ${solid_steps_total}
)");
    test::run("ln -sfn " BPLBM_SOURCE_DIR "/cases/common common", folder_.path(), 5.0);
  }
  JobResult run(const std::string& options) const {
    return test::run(
        mpirun({test::kLbm + " --progress none " + options}, {test::kLiggghts + " -screen none"}),
        folder_.path(), 60.0);
  }
  std::string file(const std::string& name) const {
    return test::read_file(folder_.path() + "/" + name);
  }
  std::string last_dump(const std::string& out) const {
    const JobResult list = test::run("ls -v " + out + "/block*.stl | tail -1", folder_.path(), 5.0);
    return file(list.output.substr(0, list.output.find('\n')));
  }
  std::string scene_file_;
  test::TemporaryFolder folder_;
};

/// Lower and upper corner of a dumped mesh.
std::array<Vec3, 2> corners(const std::string& stl) {
  std::istringstream words(stl);
  Vec3 low(1e9, 1e9, 1e9), high = -low;
  for (std::string word; words >> word;) {
    Vec3 x;
    if (word != "vertex" || !(words >> x.x() >> x.y() >> x.z())) continue;
    low = low.cwiseMin(x);
    high = high.cwiseMax(x);
  }
  return {low, high};
}

struct Case {
  std::string motion;
  double solid_steps;  ///< of its way by which LIGGGHTS may be behind, at its largest speed
  double speed;        ///< [m/s]
};

// The dump has six digits.
TEST_F(MovingBlock, IsInOnePlaceForBoth) {
  for (const Case& c :
       {Case{"motion = \"linear\"\nvelocity = [0.03, 0.02]", 0.0, 0.036},
        Case{"motion = \"rotation\"\nangular_velocity = -4.0\nabout = [0.012, 0.015]", 0.0, 0.03},
        Case{"motion = \"oscillation\"\namplitude = [0.001, 0.0005]\nfrequency = 11.0", 1.0, 0.085},
        Case{"motion = \"oscillation\"\nangular_amplitude = 0.2\nfrequency = 11.0", 1.0, 0.05}}) {
    write(c.motion);
    const JobResult job = run("--out out");
    ASSERT_EQ(job.exit_code, 0) << job.output;
    EXPECT_EQ(job.output.find("warning"), std::string::npos) << job.output;
    const Scene s = read_scene({scene_file_});
    TriangleMesh mesh = *s.obstacles[0].mesh->surface;
    const Pose pose = pose_at(*s.obstacles[0].motion, s.end_time);
    for (Vec3& v : mesh.vertices) v = pose.moved(v);
    const auto [low, high] = bounds(mesh);
    const auto [solid_low, solid_high] = corners(last_dump("out"));
    const double step = 2.6e-4;  // that of the solid is 2.5e-4 s
    const double off = std::max((low - solid_low).norm(), (high - solid_high).norm());
    std::printf("%s: corners differ by %.2g m\n", c.motion.substr(0, 24).c_str(), off);
    EXPECT_LT(off, 1e-7 + c.solid_steps * c.speed * step) << c.motion;
    EXPECT_GT((pose.moved(mesh.vertices[0]) - mesh.vertices[0]).norm(), 1e-5) << c.motion;
    test::run("rm -rf out", folder_.path(), 5.0);
  }
}

// Grains, loads on the block, and its place.
TEST_F(MovingBlock, GoesOnFromACheckpointToTheBit) {
  for (const std::string motion :
       {"motion = \"rotation\"\nangular_velocity = -4.0\nabout = [0.012, 0.015]",
        "motion = \"oscillation\"\namplitude = [0.001, 0.0005]\nfrequency = 11.0"}) {
    write(motion);
    ASSERT_EQ(run("--out whole").exit_code, 0);
    ASSERT_EQ(run("--out cut --until 0.05").exit_code, 0);
    const JobResult last = run("--out cut --restart");
    ASSERT_EQ(last.exit_code, 0) << last.output;
    EXPECT_NE(last.output.find("goes on from"), std::string::npos);
    EXPECT_EQ(last.output.find("a wall for the particles only"), std::string::npos) << last.output;
    EXPECT_EQ(file("cut/obstacles.csv"), file("whole/obstacles.csv")) << motion;
    EXPECT_EQ(file("cut/probes.csv"), file("whole/probes.csv")) << motion;
    EXPECT_EQ(last_dump("cut"), last_dump("whole")) << motion;
    EXPECT_GT(file("whole/obstacles.csv").size(), 300U);
    test::run("rm -rf cut whole", folder_.path(), 5.0);
  }
}

// A script that asks for the words of a mesh that stands is told, and one that does not move it.
TEST_F(MovingBlock, AsksForNoMotionThatIsNotThere) {
  write("motion = \"linear\"\nvelocity = [0.03, 0.02]");
  const std::string script =
      test::replaced(file("in.liggghts"), "${mesh1_motion}", "${mesh2_motion}");
  folder_.write("in.liggghts", script);
  const JobResult job = run("--out out");
  EXPECT_NE(job.exit_code, 0) << job.output;
  EXPECT_NE(job.output.find("nothing defines ${mesh2_motion}"), std::string::npos) << job.output;
  folder_.write("in.liggghts", test::replaced(script, "fix turn", "#fix turn"));
  const JobResult still = run("--out out --until 0.005");
  EXPECT_NE(still.output.find("fix block mesh/surface (of fix blocks wall/gran) stands still, and "
                              "the obstacle of the scene at its place moves"),
            std::string::npos)
      << still.output;
}

constexpr const char* kRolling = R"(title = "disc on a wall that moves along itself"
[box]
size = [0.0315, 0.0315]
[fluid]
density = 1000.0
kinematic_viscosity = 1e-5
gravity = [0.0, -9.8]
velocity_scale = 0.1
[[obstacle]]
surface_only = true
OBSTACLE
[particles]
diameter = 0.003
density = 2500.0
contact_stiffness = 50000.0
start = [[0.01575, HEIGHT]]
[numerics]
cell = 0.0005
[coupling]
[run]
end_time = 0.6
[output]
probe_every = 0.05
)";

const std::string kRollingScript = R"(
include ${scene_folder}/common/box.liggghts
create_atoms 1 single ${particle1_x} ${particle1_y} 0.0 units box
set type 1 diameter ${diameter_max} density ${density_max}
)" + test::linear_contacts("${contact_stiffness}", "400", "0.5") +
                                   R"(WALL
fix move all nve/sphere
fix weight all gravity ${gravity} vector ${gravity_x} ${gravity_y} 0.0
timestep ${solid_step}
fix fluid all lbm/couple every ${substeps}
fix flat all enforce2d
run ${solid_steps_total}
)";

struct Rolling {
  std::string name, obstacle, height, wall;
  Vec3 below;  ///< from the disc's middle to where it touches, over its radius; zero: away from the
               ///< middle of the box
};

class WallThatMovesAlongItself : public testing::TestWithParam<Rolling> {};

// A disc rolls on it, held by its weight and the liquid: its rim has the wall's speed, 0.02 m/s,
// where the two touch, to half a per cent for what they overlap.
TEST_P(WallThatMovesAlongItself, TakesGrainsAlongAtItsSpeed) {
  const Rolling& c = GetParam();
  const test::TemporaryFolder folder;
  folder.write("scene.toml", test::replaced(test::replaced(kRolling, "OBSTACLE", c.obstacle),
                                            "HEIGHT", c.height));
  folder.write("in.liggghts", test::replaced(kRollingScript, "WALL", c.wall));
  test::run("ln -sfn " BPLBM_SOURCE_DIR "/cases/common common", folder.path(), 5.0);
  const JobResult job = test::run(
      mpirun({test::kLbm + " --progress none --out out"}, {test::kLiggghts + " -screen none"}),
      folder.path(), 60.0);
  ASSERT_EQ(job.exit_code, 0) << job.output;
  std::istringstream lines(test::read_file(folder.path() + "/out/probes.csv"));
  std::string head, line, name, value;
  std::map<std::string, double> last;  // column by name
  std::getline(lines, head);
  while (std::getline(lines, line)) {
    std::istringstream names(head), values(line);
    while (std::getline(names, name, ',') && std::getline(values, value, ','))
      last[name.substr(0, name.find(' '))] = std::strtod(value.c_str(), nullptr);
  }
  Vec3 out = c.below;
  if (out.norm() == 0.0)
    out = Vec3(last.at("x") - 0.01575, last.at("y") - 0.01575, 0.0).normalized();
  const Vec3 along(-out.y(), out.x(), 0.0);
  const double rim =
      last.at("vx") * along.x() + last.at("vy") * along.y() + last.at("omega") * 0.0015;
  std::printf("%s: rim at %.4f of the wall's speed\n", c.name.c_str(), rim / 0.02);
  EXPECT_NEAR(rim / 0.02, 1.0, 0.005);
}
const std::string kMeshWall =
    "fix block all mesh/surface file ${mesh1} type 1 ${mesh1_motion}\n"
    "fix blocks all wall/gran model hooke/stiffness tangential history mesh n_meshes 1 meshes "
    "block";
INSTANTIATE_TEST_SUITE_P(
    Walls, WallThatMovesAlongItself,
    testing::Values(
        Rolling{"drum",
                "centre = [0.01575, 0.01575]\ndiameter = 0.02\nhollow = true\n"
                "motion = \"rotation\"\nangular_velocity = 2.0",
                "0.0073",
                "fix drum all wall/gran model hooke/stiffness tangential history primitive type 1 "
                "${disc1_wall}",
                {}},
        Rolling{"belt",
                "from = [0.004, 0.003]\nto = [0.0275, 0.0075]\nmotion = \"linear\"\n"
                "velocity = [0.02, 0.0]",
                "0.009",
                kMeshWall,
                {0.0, -1.0, 0.0}}),
    [](const auto& info) { return info.param.name; });

}  // namespace
