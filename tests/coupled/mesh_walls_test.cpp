// SPDX-License-Identifier: GPL-2.0-or-later
/// Meshes that LIGGGHTS stops at, and what is offered to it instead.
#include <gtest/gtest.h>

#include "tests/support/coupled_job.h"

namespace {

using test::JobResult;
using test::mpirun;

class MeshWalls : public testing::Test {
 protected:
  /// A sphere, or in two dimensions a disc, of 2 mm falls onto an obstacle in a box of 12 mm.
  void write(int dimension, const std::string& obstacle, const std::string& depth = "1.0") {
    const bool flat = dimension == 2;
    folder_.write("scene.toml", std::string("[box]\nsize = ") +
                                    (flat ? "[0.012, 0.012]\ndepth = " + depth
                                          : "[0.012, 0.012, 0.012]\nsides_x = \"periodic\"") +
                                    R"(
[fluid]
density = 1000.0
kinematic_viscosity = 1e-5
gravity = )" + (flat ? "[0.0, -9.8]" : "[0.0, 0.0, -9.8]") +
                                    R"(
velocity_scale = 0.15
[particles]
diameter = 0.002
density = 2500.0
contact_stiffness = 500.0
start = )" + (flat ? "[[0.006, 0.0085]]" : "[[0.006, 0.006, 0.0085]]") +
                                    R"(
[particles.variables]
damping_ratio = 0.5
[numerics]
cell = 0.0005
[coupling]
[run]
end_time = 0.05
[output]
probe_every = 0.01
[[obstacle]]
)" + obstacle);
    const std::string common = BPLBM_SOURCE_DIR "/cases/common/";
    const std::string walls =
        "fix mesh all mesh/surface file MESH type 1\n"
        "fix meshes all wall/gran model hooke/stiffness tangential history mesh n_meshes 1 meshes "
        "mesh\n" +
        std::string(obstacle.find("motion") == std::string::npos
                        ? ""
                        : "fix turn all move/mesh mesh mesh ${mesh1_motion}\n");
    const std::string script =
        test::read_file(common + "box.liggghts") +
        "create_atoms 1 single ${particle1_x} ${particle1_y} " + (flat ? "0.0" : "${particle1_z}") +
        " units box\n" + test::read_file(common + (flat ? "discs.liggghts" : "spheres.liggghts"));
    script_ = test::replaced(script, "fix              move", walls + "fix              move");
  }
  JobResult run(const std::string& mesh = "${mesh1}") {
    folder_.write("in.liggghts", test::replaced(script_, "MESH", mesh));
    return test::run(
        mpirun({test::kLbm + " --progress none --out out"}, {test::kLiggghts + " -screen none"}),
        folder_.path(), 60.0);
  }
  /// Height of the grain at the end over that at the start.
  double sunk() const {
    const auto rows = test::read_rows(folder_.path() + "/out/probes.csv");
    return rows.back()[flat() ? 3 : 4] - rows.front()[flat() ? 3 : 4];
  }
  bool flat() const { return script_.find("enforce2d") != std::string::npos; }
  test::TemporaryFolder folder_;
  std::string script_;
};

// Through the periodic sides and through walls; the grain rests on it.
TEST_F(MeshWalls, ARodThatReachesBeyondTheBoxIsCutForTheSolid) {
  for (const char* ends : {"from = [0.0, 0.006, 0.004]\nto = [0.012, 0.006, 0.004]",
                           "from = [0.006, -0.02, 0.004]\nto = [0.006, 0.02, 0.004]"}) {
    write(3, std::string(ends) + "\ndiameter = 0.003\n");
    const JobResult job = run();
    test::expect_end(job, 0, {});
    for (const char* words : {"left the domain", "Bad mesh", "Not all nodes", "highly skewed"})
      EXPECT_EQ(job.output.find(words), std::string::npos) << job.output;
    // from 8.5 mm down to 4 + 1.5 + 1 mm
    EXPECT_NEAR(sunk(), -0.002, 1e-4) << ends;
  }
}

// A mesh that does not come from the scene is not cut: LIGGGHTS's words, and what to do.
TEST_F(MeshWalls, AMeshBeyondTheBoxIsNamedWithItsCure) {
  write(3, "from = [0.006, -0.02, 0.004]\nto = [0.006, 0.02, 0.004]\ndiameter = 0.003\n");
  folder_.write("far.stl",
                "solid far\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0.02\nvertex 0.01 0 0.02\n"
                "vertex 0 0.01 0.02\nendloop\nendfacet\nendsolid far\n");
  test::expect_end(run("far.stl"), 1, {"left the domain", "what to do", "${mesh1}"});
}

// A layer of two and a half grains, and of one; the block is 6 mm long.
TEST_F(MeshWalls, ABlockMovesInAThinLayer) {
  for (const char* depth : {"0.005", "0.002"}) {
    write(2,
          "from = [0.003, 0.003]\nto = [0.009, 0.005]\nmotion = \"oscillation\"\n"
          "amplitude = [0.0, 0.0003]\nfrequency = 10.0\n",
          depth);
    const JobResult job = run();
    test::expect_end(job, 0, {});
    EXPECT_EQ(job.output.find("assertion"), std::string::npos) << job.output;
    // from 8.5 mm down to 5 + 1 mm, while the block goes up and down by 0.3 mm, and its surface in
    // cells of 0.5 mm
    EXPECT_NEAR(sunk(), -0.0025, 6e-4) << depth;
  }
}

// The script places the grain, in the rod: the cause is said when it starts. The rod is five
// diameters long, whose facets LIGGGHTS would refuse as they are.
TEST_F(MeshWalls, AGrainThatBeginsInAnObstacleIsNamed) {
  write(3, "from = [0.001, 0.006, 0.004]\nto = [0.011, 0.006, 0.004]\ndiameter = 0.002\n");
  script_ = test::replaced(script_, "${particle1_z}", "0.0053");
  const JobResult job = run();
  EXPECT_NE(job.output.find("particle 1 begins 0.7 of its radius deep in the 1. obstacle (mesh of "
                            "a cylinder): a contact throws it out"),
            std::string::npos)
      << job.output;
  EXPECT_EQ(job.output.find("Bad mesh"), std::string::npos) << job.output;
  test::expect_end(
      job, 3,
      {"Particle 1 began 0.7 of its radius deep in the 1. obstacle (mesh of a cylinder), "
       "was thrown out, and has left the box since. What to do: start it outside"});
}

// LIGGGHTS would divide by the distance.
TEST_F(MeshWalls, AGrainThatBeginsInASurfaceIsRefused) {
  write(3,
        "from = [0.002, 0.002, 0.002]\nto = [0.01, 0.01, 0.005]\nmotion = \"linear\"\n"
        "velocity = [0.0, 0.0, -0.001]\n");
  script_ = test::replaced(script_, "${particle1_z}", "0.005");
  test::expect_end(run(), 2,
                   {"particle 1 begins at [0.006, 0.006, 0.005], its centre in the surface of the "
                    "1. obstacle (mesh of a block)",
                    "start it beside"});
}

}  // namespace
