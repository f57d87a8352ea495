// SPDX-License-Identifier: GPL-2.0-or-later
/// Clumps of LIGGGHTS in a box of fluid: scene, script, runs, and the rows that are written of
/// them.
#pragma once

#include <gtest/gtest.h>

#include <array>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include "tests/support/coupled_job.h"
#include "tests/support/script_parts.h"

namespace test {

inline constexpr const char* kClumpScene = R"(title = "clump"
[box]
size = [0.012, 0.012, 0.018]
[fluid]
density = 1000.0
kinematic_viscosity = 1e-5
gravity = [0.0, 0.0, -9.81]
velocity_scale = 0.1
[particles]
diameter = 0.003
density = 1000.0
contact_stiffness = 1.0e3
[numerics]
cell = 0.0005
[coupling]
timeout = 30.0
[output]
probe_every = 0.005
[run]
end_time = 0.05
)";

inline const std::string kClumpScript = kSpheresHead + R"(processors PROCESSORS
if "${restart} == 1" then "read_restart ${restart_file}" else "create_box 1 domain"
)" + kHertzContacts + box_walls(kHertz, "xyz") +
                                        R"(BODIES
if "${restart} == 0" then "run 1"
fix weight all gravity ${gravity} vector 0.0 0.0 -1.0
fix fluid all lbm/couple every ${substeps}
run ${solid_steps_total}
)";

/// Two spheres 1 mm apart, one body of fix multisphere.
inline std::string multisphere(const std::string& density,
                               const std::string& velocity = "0. 0. 0.") {
  return "fix one all particletemplate/multisphere 15485863 atom_type 1 density constant " +
         density +
         " nspheres 2 ntry 1000000 spheres file two.txt scale 0.001 type 1\n"
         "fix all_of all particledistribution/discrete 32452843 1 one 1.0\n"
         "region middle block 0.0055 0.0065 0.0055 0.0065 0.0105 0.0115 units box\n"
         "if \"${restart} == 0\" then \"fix put all insert/pack seed 32452867 distributiontemplate "
         "all_of insert_every once overlapcheck yes all_in no vel constant " +
         velocity +
         " region middle particles_in_region 1\"\n"
         "fix move all multisphere";
}

class Clumps : public testing::Test {
 protected:
  Clumps() { folder_.write("two.txt", "-0.5 0 0 1.5\n0.5 0 0 1.5\n"); }

  JobResult run(const std::string& bodies, const std::string& scene = kClumpScene, int fluids = 1,
                int solids = 1, const std::string& options = "--out out") {
    return run_script(replaced(kClumpScript, "BODIES", bodies), scene, fluids, solids, options);
  }
  JobResult run_script(const std::string& script, const std::string& scene, int fluids = 1,
                       int solids = 1, const std::string& options = "--out out",
                       double limit = 100.0) {
    folder_.write("scene.toml", scene);
    folder_.write("in.liggghts", replaced(script, "PROCESSORS", solids == 1 ? "1 1 1" : "1 1 2"));
    return test::run(mpirun({kLbm + " --progress none " + options, fluids},
                            {kLiggghts + " -in in.liggghts", solids}),
                     folder_.path(), limit);
  }

  using Row = std::array<double, 17>;  // of probes.csv in three dimensions
  /// Rows of particles, or of clumps, whose ids are below −1. Two dimensions have ten columns.
  std::vector<Row> rows(const std::string& out, bool clump) const {
    return rows_where(out, [=](double id) { return (id < -1.0) == clump; });
  }
  template <class Chosen>
  std::vector<Row> rows_where(const std::string& out, const Chosen& chosen) const {
    std::ifstream file(folder_.path() + "/" + out + "/probes.csv");
    std::vector<Row> all;
    std::string line, number;
    std::getline(file, line);
    while (std::getline(file, line)) {
      std::istringstream numbers(line);
      Row row{};
      for (double& value : row) {
        if (!std::getline(numbers, number, ',')) break;
        value = std::stod(number);
      }
      if (chosen(row[1])) all.push_back(row);
    }
    return all;
  }

  TemporaryFolder folder_;
};

inline std::string heavy(double density) {
  return replaced(kClumpScene, "density = 1000.0\ncontact",
                  "density = " + std::to_string(density) + "\ncontact");
}

/// Two spheres that overlap, joined by fix rigid, which counts both whole: their density is that of
/// the union, 20.944 mm³, over the sum, 28.274 mm³.
inline const std::string kRigid =
    "if \"${restart} == 0\" then \"create_atoms 1 single 0.0055 0.006 0.011 units box\" "
    "\"create_atoms 1 single 0.0065 0.006 0.011 units box\" \"set type 1 diameter 0.003 density "
    "1851.86\"\nneigh_modify exclude group all all\nfix move all rigid single";

}  // namespace test
