// SPDX-License-Identifier: GPL-2.0-or-later
/// What was agreed stays agreed, with the real programs: a step, box, size or density that changes,
/// clumps, heaps, walls that only one side has. Both programs end with exit code 2.
#include <gtest/gtest.h>

#include <fstream>
#include <map>
#include <sstream>

#include "tests/support/coupled_job.h"
#include "tests/support/script_parts.h"

namespace {

using test::JobResult;
using test::mpirun;
using test::replaced;
using test::SettlingDisc;

void expect_both_refuse(const JobResult& job, const std::vector<std::string>& words) {
  EXPECT_FALSE(job.timed_out) << "hangs: " << job.output;
  EXPECT_EQ(job.exit_code, 2) << job.output;
  for (const auto& word : words)
    EXPECT_NE(job.output.find(word), std::string::npos) << word << " not in:\n" << job.output;
  EXPECT_NE(job.output.find("lbm | error | "), std::string::npos) << job.output;
  EXPECT_EQ(job.output.find("velocity_scale)"), std::string::npos) << job.output;
}

// ---- scripts of LIGGGHTS
// -------------------------------------------------------------------------

struct ScriptFault {
  std::string name, from, to;
  std::vector<std::string> words;
};
void PrintTo(const ScriptFault& f, std::ostream* out) {
  *out << f.name;
}

const std::string kRun = "run              ${solid_steps_total}";
const std::string kCreate = "create_atoms 1 single ${particle1_x} ${particle1_y} 0.0 units box";

class ScriptFaultTest : public testing::TestWithParam<ScriptFault> {};

TEST_P(ScriptFaultTest, IsNamedByBoth) {
  SettlingDisc scene;
  scene.change_script(GetParam().from, GetParam().to);
  const auto job = scene.run("", 1, 50.0);
  expect_both_refuse(job, GetParam().words);
  EXPECT_NE(job.output.find("liggghts | error | "), std::string::npos) << job.output;
}

INSTANTIATE_TEST_SUITE_P(
    Agreed, ScriptFaultTest,
    testing::Values(
        ScriptFault{
            "dt_reset",
            kRun,
            "fix reset all dt/reset 1 1e-9 1e-5 1e-9\n" + kRun,
            {"the time step is ", "agreed with the fluid was ", "take out fix reset dt/reset"}},
        ScriptFault{
            "deform",
            kRun,
            "fix df all deform 10 y scale 0.9\n" + kRun,
            {"the box y is ", "agreed with the fluid was 0 … 0.06 m", "take out fix df deform"}},
        ScriptFault{"change_box",
                    kRun,
                    "run 90\nchange_box all y final 0.0 0.061 units box\nrun 90",
                    {"since the last run", "box y: fluid 0 … 0.06 m, solid 0 … 0.061 m"}},
        ScriptFault{"gravity_later",
                    kRun,
                    "run 90\nunfix weight\nrun 90",
                    {"since the last run", "gravity: fluid (0, -9.8, 0)"}},
        ScriptFault{"smaller_later",
                    kRun,
                    "run 90\ncreate_atoms 1 single 0.005 0.02 0.0 units box\n"
                    "set atom 2 diameter 0.0004 density ${disc_density}\nrun 90",
                    {"particle radius: fluid's scene says 0.00125", "solid has 0.0002"}},
        ScriptFault{"lighter_later",
                    kRun,
                    "run 90\ncreate_atoms 1 single 0.005 0.02 0.0 units box\n"
                    "set atom 2 diameter ${diameter_max} density 200\nrun 90",
                    {"particle density: fluid's scene says 1250", "solid has 200"}},
        ScriptFault{"rigid_clump",
                    "fix              move all nve/sphere",
                    "create_atoms 1 single 0.0116 0.04 0.0 units box\nset type 1 diameter "
                    "${diameter_max} density ${disc_density}\nfix move all rigid single",
                    {"density", "scene's particles.density says 1250 … 1250", "kg in"}},
        ScriptFault{
            "heap",
            kRun,
            "variable i loop 4000\nlabel more\ncreate_atoms 1 single 0.01 0.02 0.0 units box"
            "\nnext i\njump SELF more\nset type 1 diameter ${diameter_max} density "
            "${disc_density}\n" +
                kRun,
            {"overlap: their centres (0.01, 0.02, 0)", "are 0 m apart",
             "the centre of one lies in the other"}}),
    [](const auto& info) { return info.param.name; });

// ---- three dimensions
// ----------------------------------------------------------------------------

/// A short scene in a small box, and a script to be completed: mesh walls and clumps are made for
/// three dimensions.
class Spheres {
 public:
  Spheres() {
    folder_.write("scene.toml", R"(title = "spheres"
[box]
size = [0.012, 0.012, 0.018]
[fluid]
density = 1000.0
kinematic_viscosity = 1e-5
gravity = [0.0, 0.0, -9.81]
velocity_scale = 0.3
[particles]
diameter = 0.003
density = 2500.0
contact_stiffness = 1.0e3
[numerics]
cell = 0.0005
[coupling]
timeout = 100.0
[run]
end_time = 0.01
)");
    // a square floor of two triangles at z = 3 mm
    folder_.write("floor.stl", R"(solid floor
facet normal 0 0 1
outer loop
vertex 0 0 0.003
vertex 0.012 0 0.003
vertex 0.012 0.012 0.003
endloop
endfacet
facet normal 0 0 1
outer loop
vertex 0 0 0.003
vertex 0.012 0.012 0.003
vertex 0 0.012 0.003
endloop
endfacet
endsolid floor
)");
  }
  void add_to_scene(const std::string& text) {
    std::ofstream(folder_.path() + "/scene.toml", std::ios::app) << text;
  }
  JobResult run(const std::string& walls, const std::string& move = "fix move all nve/sphere") {
    std::string script = test::kSpheresHead + "create_box 1 domain\n" + test::kHertzContacts +
                         R"(create_atoms 1 single 0.006 0.006 0.012 units box
set type 1 diameter 0.003 density 2500
)";
    script += walls + "\n" + move + R"(
fix weight all gravity ${gravity} vector 0.0 0.0 -1.0
fix fluid all lbm/couple every ${substeps}
thermo_modify lost ignore
run ${solid_steps_total}
)";
    folder_.write("in.liggghts", script);
    return test::run(mpirun({test::kLbm + " --progress none"}, {test::kLiggghts + " -screen none"}),
                     folder_.path(), 60.0);
  }

 private:
  test::TemporaryFolder folder_;
};

const std::string kWall = " all wall/gran model hertz tangential history primitive type 1 ";
const std::string kSides = "fix x1" + kWall + "xplane ${x_lo}\nfix x2" + kWall +
                           "xplane ${x_hi}\nfix y1" + kWall + "yplane ${y_lo}\nfix y2" + kWall +
                           "yplane ${y_hi}\nfix z2" + kWall + "zplane ${z_hi}";
const std::string kFloor = "\nfix z1" + kWall + "zplane ${z_lo}";

void expect_warnings(const JobResult& job, const std::vector<std::string>& words) {
  EXPECT_EQ(job.exit_code, 0) << job.output;
  for (const auto& word : words)
    EXPECT_NE(job.output.find("| warning  | " + word), std::string::npos) << word << " not in:\n"
                                                                          << job.output;
  std::size_t count = 0;
  for (std::size_t at = 0; (at = job.output.find("| warning  | ", at)) != std::string::npos; ++at)
    ++count;
  EXPECT_EQ(count, words.size()) << job.output;
}

TEST(OneSidedWalls, ThereAreNoneWhereBothHaveAll) {
  expect_warnings(Spheres().run(kSides + kFloor), {});
}

TEST(OneSidedWalls, AWallThatTheScriptLacksIsNamed) {
  expect_warnings(Spheres().run(kSides),
                  {"side back (z = 0 m) is a wall for the fluid, no plane wall of the solid"});
}

// In the side, or before it: then the fluid does not know it, but no sphere comes to the side.
TEST(OneSidedWalls, AMeshThatCoversASideIsItsWall) {
  const std::string floor =
      "\nfix plates all wall/gran model hertz tangential history mesh n_meshes 1 meshes plate";
  expect_warnings(
      Spheres().run(kSides +
                    "\nfix plate all mesh/surface file floor.stl type 1 move 0. 0. -0.003" + floor),
      {});
  expect_warnings(
      Spheres().run(kSides + "\nfix plate all mesh/surface file floor.stl type 1" + floor),
      {"fix plate mesh/surface (of fix plates wall/gran) is a wall for the particles only"});
}

TEST(OneSidedWalls, MeshesCylindersAndPlanesInsideAreNamed) {
  expect_warnings(
      Spheres().run(
          kSides + kFloor +
          "\nfix plate all mesh/surface file floor.stl type 1\nfix plates all wall/gran model "
          "hertz tangential history mesh n_meshes 1 meshes plate\nfix pipe" +
          kWall + "zcylinder 0.006 0.006 0.006\nfix sieve" + kWall + "zplane 0.005"),
      {"fix plate mesh/surface (of fix plates wall/gran) is a wall for the particles only",
       "fix pipe wall/gran (cylinder) is a wall for the particles only",
       "fix sieve wall/gran (plane z = 0.005 m) is a wall for the particles only"});
}

constexpr const char* kFloorMesh = "\n[[obstacle]]\nmesh = \"floor.stl\"\nthickness = 0.002\n";

// The fluid makes a plate of the surface and offers it as ${mesh1}: both meet the same wall.
TEST(OneSidedWalls, AMeshThatBothHaveIsNotNamed) {
  Spheres spheres;
  spheres.add_to_scene(kFloorMesh);
  const JobResult job =
      spheres.run(kSides + kFloor +
                  "\nfix plate all mesh/surface file ${mesh1} type 1\nfix plates all wall/gran "
                  "model hertz tangential history mesh n_meshes 1 meshes plate");
  EXPECT_EQ(job.exit_code, 0) << job.output;
  expect_warnings(job, {});
  EXPECT_NE(job.output.find("mesh floor.stl: 12 triangles"), std::string::npos) << job.output;
}

TEST(OneSidedWalls, AMeshOfTheFluidAloneIsNamed) {
  Spheres spheres;
  spheres.add_to_scene(kFloorMesh);
  expect_warnings(spheres.run(kSides + kFloor),
                  {"obstacle: mesh from (0, 0, 0.002) to (0.012, 0.012, 0.004) m: there for the "
                   "fluid only"});
}

TEST(Shapes, ThatAreNoSpheresAreRefusedByName) {
  expect_both_refuse(Spheres().run(kSides + kFloor, "fix move all multisphere/nointegration"),
                     {"fix move multisphere/nointegration has particles that are neither spheres",
                      "liggghts | error | "});
}

// ---- any engine
// ----------------------------------------------------------------------------------

class EngineFault : public testing::TestWithParam<std::pair<std::string, std::string>> {};

TEST_P(EngineFault, IsNamedAtItsExchange) {
  const auto& [script, reason] = GetParam();
  SettlingDisc scene;
  expect_both_refuse(test::run(mpirun({test::kLbm + " --progress none"},
                                      {test::kBin + "/scripted_peer solid " + script}),
                               scene.folder(), 50.0),
                     {reason, "scripted_peer | error | "});
}

INSTANTIATE_TEST_SUITE_P(
    Agreed, EngineFault,
    testing::Values(
        std::pair{"heap", "interval 0: particles 0 and 1 overlap"},
        std::pair{"step", "interval 3: the solid's time step is "},
        std::pair{"box", "interval 3: the solid's box y is 0 … 0.054 m, agreed was 0 … 0.06 m"},
        std::pair{"outside", "particle 4: its centre (5, 0.04, 0) m lies far outside"},
        std::pair{"jump",
                  "particle 4 jumped from (0.01, 0.04, 0) to (0.01, 0.015, 0) m in interval 3: 10 "
                  "diameters"},
        std::pair{"grow", "particle 4: diameter 0.005 m at interval 3"},
        std::pair{"dense", "particle 4: density 2500 kg/m³ at interval 3"},
        std::pair{"clump", "particle 4 is a sphere of clump 1, which this rank does not send"}),
    [](const auto& info) { return info.param.first; });

// ---- an id that passes to another particle
// -------------------------------------------------------

// Three discs, one of which rests; LIGGGHTS renumbers when that is deleted. The load on the disc
// that gets its id begins anew: it differs from the one before by less than that, where the
// velocity of the resting disc taken for its own made it some thirty times as large.
TEST(Renumbering, TheLoadOfTheNewOwnerIsItsOwn) {
  SettlingDisc scene;
  scene.change_scene("start = [[0.01, 0.04]]", "");
  scene.change_scene("probe_every = 0.001", "probe_every = 0.0");
  scene.change_script(
      kCreate,
      "create_atoms 1 single 0.004 0.00125 0.0 units box\" \"create_atoms 1 single "
      "0.010 0.03 0.0 units box\" \"create_atoms 1 single 0.016 0.04 0.0 units box");
  scene.change_script(kRun, "run 1000\ngroup gone id 1\ndelete_atoms group gone\nrun 1000");
  const auto job = scene.run();
  ASSERT_EQ(job.exit_code, 0) << job.output;
  std::istringstream rows(scene.output("probes.csv"));
  std::string line;
  std::getline(rows, line);
  std::map<int, double> now;  // vertical load by id, of one time
  std::map<int, double> before;
  double time = -1.0;
  bool seen = false;
  while (std::getline(rows, line)) {
    double t = 0.0, id = 0.0, fy = 0.0;
    std::istringstream row(line);
    std::string cell;
    for (int column = 0; std::getline(row, cell, ','); ++column) {
      if (column == 0) t = std::stod(cell);
      if (column == 1) id = std::stod(cell);
      if (column == 8) fy = std::stod(cell);
    }
    if (t != time) {
      if (before.size() == 3 && now.size() == 2) {
        seen = true;
        for (const int i : {1, 2}) {
          const double old = before.at(i + 1);  // by its id before
          EXPECT_NEAR(now.at(i), old, std::abs(old)) << "particle " << i << " at " << time;
        }
      }
      before = std::exchange(now, {});
      time = t;
    }
    now[static_cast<int>(id)] = fy;
  }
  EXPECT_TRUE(seen) << "no renumbering was seen";
}

}  // namespace
