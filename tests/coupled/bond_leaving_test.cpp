// SPDX-License-Identifier: GPL-2.0-or-later
/// Bonded grains that leave the box take their bonds with them, and are counted; several fixes that
/// make bonds add up.
#include <nlohmann/json.hpp>

#include "tests/support/bond_script.h"

namespace {

using namespace test;

void expect_in(const std::string& text, const std::string& part) {
  EXPECT_NE(text.find(part), std::string::npos) << part << "\nis not in\n" << text;
}

/// A square lattice of bonded discs that flies out of a box, a row at a time, and turns. Counts are
/// printed at the end.
std::string flying_cluster() {
  std::string discs;
  for (int j = 0; j < 8; ++j)
    for (int i = 0; i < 8; ++i) discs += disc(0.7 + 0.03 * i, 0.3 + 0.03 * j);
  return head() + discs +
         "set group all diameter 0.03 density 1000\nvelocity all set 2 1 0 units box\n" +
         model({1e5, 5e4, 60.0, 60.0, 0.05}, "bond/contact") + kBonds +
         "fix move all nve/sphere\nfix flat all enforce2d\ntimestep 4e-5\n"
         "thermo_modify lost ignore\nrun 2500\n"
         "print \"atoms $(atoms) created $(f_breaks[4]) intact $(f_breaks[1]) broken "
         "$(f_breaks[2]+f_breaks[3]) left $(f_breaks[10]) lost $(f_breaks[11])\"\n";
}

std::string line_with(const std::string& output, const std::string& start) {
  const std::size_t at = output.find(start);
  return at == std::string::npos ? output : output.substr(at, output.find('\n', at) - at);
}

TEST(BondsThatLeave, AreCountedAlikeOnAnyNumberOfRanks) {
  std::string one;
  for (const int ranks : {1, 2, 4}) {
    Script script;
    const auto job = script.run(flying_cluster(), ranks);
    expect_ok(job);
    const std::string counts = line_with(job.output, "atoms ");
    int atoms = 0, created = 0, intact = 0, broken = 0, left = 0, lost = 0;
    ASSERT_EQ(std::sscanf(counts.c_str(), "atoms %d created %d intact %d broken %d left %d lost %d",
                          &atoms, &created, &intact, &broken, &left, &lost),
              6)
        << counts;
    EXPECT_LT(atoms, 64);
    EXPECT_GT(atoms, 0);
    EXPECT_EQ(created, 112);
    EXPECT_GT(left, 0);
    EXPECT_EQ(lost, 0);
    EXPECT_EQ(created, intact + broken + left);
    if (ranks == 1) one = counts;
    EXPECT_EQ(counts, one);
  }
}

// What is bonded after the restart, and what had left before it, is counted on.
TEST(BondsThatLeave, AreKeptInRestartFiles) {
  Script script;
  const auto whole = script.run(flying_cluster());
  expect_ok(whole);
  expect_ok(
      script.run(replaced(flying_cluster(), "run 2500\n", "run 1500\nwrite_restart half.rst\n")));
  std::string again = replaced(flying_cluster(), "run 2500\n", "run 1000\n");
  const std::size_t from = again.find("region box"), to = again.find("fix contactNormalStiffness");
  again = again.substr(0, from) +
          "read_restart half.rst\nneighbor 0.02 bin\nneigh_modify delay 0\n" + again.substr(to);
  const auto rest = script.run(again, 1, "in.again");
  expect_ok(rest);
  EXPECT_EQ(line_with(rest.output, "atoms "), line_with(whole.output, "atoms "));
}

TEST(BondsThatLeave, WithGrainsThatTheScriptTakesOutAreLost) {
  Script script;
  const auto job =
      script.run(replaced(pulled_pair({}, "0 0 0"), "run 2500\n",
                          "run 200\ngroup out id 2\ndelete_atoms group out compress no\nrun 200\n"
                          "print \"left $(f_breaks[10]) lost $(f_breaks[11])\"\n"));
  expect_ok(job);
  expect_in(job.output, "1 bonds were lost between two runs");
  expect_in(job.output, "left 0 lost 1");
}

// The default of delete_atoms gives the ids that are free to others, by which bonds are known.
TEST(BondsThatLeave, WithOtherIdsAreRefused) {
  Script script;
  const auto job =
      script.run(replaced(pulled_pair({}, "0 0 0"), "run 2500\n",
                          "run 200\ngroup out id 1\ndelete_atoms group out\nrun 200\n"));
  EXPECT_NE(job.exit_code, 0) << job.output;
  expect_in(job.output,
            "1 particles have another id than in the last run, and bonds are known by ids; write "
            "'delete_atoms … compress no'");
}

/// Discs of types 1, 1, 2, 2 in a row, all touching.
std::string two_types(const std::string& creators) {
  std::string text = head() + disc(0.35, 0.5) + disc(0.45, 0.5) + disc(0.55, 0.5) +
                     disc(0.65, 0.5) + "set type 1 diameter 0.1 density 1000\n" +
                     "set atom 3*4 type 2\n" + model({}) + creators +
                     "fix breaks all bond/breaks every 1 file breaks.csv\ntimestep 1e-5\nrun 1\n"
                     "print \"created $(f_breaks[4]) intact $(f_breaks[1])\"\n";
  text = replaced(text, "create_box 1", "create_box 2");
  for (std::size_t at = 0; (at = text.find("peratomtypepair 1 ", at)) != std::string::npos;) {
    const std::size_t value = at + 18, end = text.find('\n', value);
    const std::string v = " " + text.substr(value, end - value);
    text.replace(at, end - at, "peratomtypepair 2" + v + v + v + v);
  }
  return text;
}

TEST(BondCreate, SeveralAddUp) {
  Script script;
  const std::string first = "fix soft all bond/create gap 1e-6 types 1 1\n",
                    second = "fix hard all bond/create gap 1e-6 types 2 2\n",
                    all = "fix every all bond/create gap 1e-6\n";
  auto job = script.run(two_types(first + second));
  expect_ok(job);
  expect_in(job.output, "bonds created: 1 by fix bond/create soft; 2 in all");
  expect_in(job.output, "bonds created: 1 by fix bond/create hard; 2 in all");
  expect_in(job.output, "created 2 intact 2");
  job = script.run(two_types(first + second + all));
  expect_ok(job);
  expect_in(job.output,
            "bonds created: 1 by fix bond/create every (2 of its pairs were bonded before); 3 in");
  expect_in(job.output, "created 3 intact 3");
  // a fix that is taken back before the run makes nothing
  job = script.run(two_types(first + second + "unfix soft\n"));
  expect_ok(job);
  expect_in(job.output, "created 1 intact 1");
  // in a later run one more adds to what there is
  job = script.run(replaced(two_types(first), "run 1\n", "run 1\n" + all + "run 1\n"));
  expect_ok(job);
  expect_in(job.output, "created 3 intact 3");
}

TEST(BondCreate, SeveralHaveOneSpread) {
  Script script;
  const auto job =
      script.run(two_types("fix soft all bond/create gap 1e-6 types 1 1\n"
                           "fix hard all bond/create gap 1e-6 types 2 2 spread 0.2 "
                           "seed 5\n"));
  EXPECT_NE(job.exit_code, 0);
  expect_in(job.output, "give all of these fixes the same");
}

/// Two bonded discs in a stream that carries them out of its box.
const std::string kScene = R"(
[box]
size = [0.04, 0.02]
sides_y = "periodic"
[fluid]
density = 1000.0
kinematic_viscosity = 1e-5
velocity_scale = 0.2
[[boundary]]
side = "left"
kind = "velocity"
velocity = [0.1, 0.0]
[[boundary]]
side = "right"
kind = "pressure"
[initial]
kind = "uniform"
velocity = [0.1, 0.0]
[particles]
diameter = 0.002
density = 1500.0
contact_stiffness = 1.0e4
[particles.variables]
bond_stiffness = 1.0e4
bond_strength = 1.0
bond_shear_strength = 1.0
bond_gap = 1.0e-5
damping_ratio = 0.5
friction = 0.4
[numerics]
cell = 0.0004
[coupling]
timeout = 100.0
[run]
end_time = 0.2
[output]
probe_every = 0.01
)";
const std::string kScript = R"(
include ${scene_folder}/../common/box.liggghts
variable disc_density equal ${density_max}*${depth}
create_atoms 1 single 0.030 0.01 0.0 units box
create_atoms 1 single 0.032 0.01 0.0 units box
set type 1 diameter ${diameter_max} density ${disc_density}
include ${scene_folder}/../common/bonded.liggghts
fix move all nve/sphere
timestep ${solid_step}
thermo 20000
thermo_modify lost ignore
fix bonds all bond/create gap ${bond_gap}
fix breaks all bond/breaks every 100 file ${out_folder}/breaks.csv
fix fluid all lbm/couple every ${substeps}
fix flat all enforce2d
run ${solid_steps_total}
)";

/// Runs a scene and a script, and keeps the folder.
class BondedDiscs : public testing::TestWithParam<int> {
 protected:
  JobResult couple(const std::string& scene, const std::string& script, int solid_ranks = 1) {
    folder_.write("scene.toml", scene);
    folder_.write("in.liggghts", replaced(script, "${scene_folder}/../common",
                                          std::string(BPLBM_SOURCE_DIR) + "/cases/common"));
    return run(mpirun({kLbm + " --progress tenths"}, {kLiggghts + " -screen none", solid_ranks}),
               folder_.path(), 60.0);
  }
  std::string output(const std::string& name) const {
    return read_file(folder_.path() + "/out/" + name);
  }

 private:
  TemporaryFolder folder_;
};
using BondedPairLeaves = BondedDiscs;

TEST_P(BondedPairLeaves, AndTheRunGoesOn) {
  const auto job = couple(kScene, kScript, GetParam());
  EXPECT_EQ(job.exit_code, 0) << job.output;
  const std::string counts =
      "2 grains left, bonds 0 (broken by tension 0, by shear 0; left with grains 1)";
  expect_in(job.output, "m/s, " + counts);
  expect_in(job.output, "solid        " + counts);
  const auto summary = nlohmann::json::parse(output("summary.json"));
  EXPECT_EQ(summary["ending"], "complete");
  EXPECT_EQ(summary["grains"]["left"], 2);
  EXPECT_EQ(summary["bonds"],
            nlohmann::json::parse(R"({"intact":0,"tension":0,"shear":0,"left":1,"lost":0})"));
}
INSTANTIATE_TEST_SUITE_P(SolidRanks, BondedPairLeaves, testing::Values(1, 2));

// One bond breaks before the fluid comes, one after: the table has the fluid's time for both.
TEST_F(BondedDiscs, BreakAtTheTimeOfTheFluid) {
  const std::string scene = replaced(replaced(kScene, "bond_strength = 1.0", "bond_strength = 0.1"),
                                     "end_time = 0.2", "end_time = 0.02");
  std::string script = replaced(kScript, "create_atoms 1 single 0.030 0.01 0.0 units box\n",
                                "create_atoms 1 single 0.005 0.005 0.0 units box\n"
                                "create_atoms 1 single 0.007 0.005 0.0 units box\n");
  script = replaced(script, "create_atoms 1 single 0.032 0.01 0.0 units box\n",
                    "create_atoms 1 single 0.005 0.015 0.0 units box\n"
                    "create_atoms 1 single 0.007 0.015 0.0 units box\n");
  script = replaced(script, "fix move all nve/sphere\n",
                    "group pulled id 2\ngroup others id 1 3 4\n"
                    "fix pull pulled move linear 0.1 0 0\nfix hold others move linear 0 0 0\n");
  script = replaced(script, "fix fluid",
                    "run 100\nunfix pull\nunfix hold\nset atom 2 vx 0\nset atom 4 vx 0.15\n"
                    "fix move all nve/sphere\nfix fluid");
  const auto job = couple(scene, script);
  ASSERT_EQ(job.exit_code, 0) << job.output;
  const auto summary = nlohmann::json::parse(output("summary.json"));
  const double step =
      summary["parameters"]["interval"].get<double>() / summary["substeps"].get<double>();
  const auto breaks = rows(output("breaks.csv"));
  ASSERT_EQ(breaks.size(), 2U) << output("breaks.csv") << job.output;
  for (const auto& row : breaks)
    EXPECT_NEAR(std::stod(row[1]), step * (std::stod(row[0]) - 100.0), 1e-12);
  EXPECT_LT(std::stod(breaks[0][1]), 0.0);
  EXPECT_GT(std::stod(breaks[1][1]), 0.0);
  EXPECT_EQ(output("breaks.csv").substr(0, 33), "step [1],time [s],id1 [1],id2 [1]");
}

}  // namespace
