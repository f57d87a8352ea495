// SPDX-License-Identifier: GPL-2.0-or-later
/// Everything that can go wrong between the programs: both end with the right reason and exit code.
/// Nothing hangs: each job's limit is shorter than the time-out of its scene.
#include <gtest/gtest.h>

#include "tests/support/coupled_job.h"

namespace {

using test::expect_end;
using test::JobResult;
using test::kLbm;
using test::kLiggghts;
using test::mpirun;
using test::SettlingDisc;

const std::string kPeer = test::kBin + "/scripted_peer";

// ---- the two disagree: refusal, exit 2, the same text on both sides
// --------------------------------

struct Mismatch {
  std::string name, from, to, reason;
};
void PrintTo(const Mismatch& m, std::ostream* out) {
  *out << m.name;
}

class MismatchTest : public testing::TestWithParam<Mismatch> {};

TEST_P(MismatchTest, IsRefusedByBothWithTheReason) {
  SettlingDisc scene;
  scene.change_script(GetParam().from, GetParam().to);
  const auto job = scene.run("", 1, 50.0);
  expect_end(job, 2, {"lbm | error | fluid and solid disagree", GetParam().reason});
  std::size_t count = 0;
  for (std::size_t at = 0; (at = job.output.find(GetParam().reason, at)) != std::string::npos; ++at)
    ++count;
  EXPECT_EQ(count, 2U) << "both programs say it:\n" << job.output;
}

INSTANTIATE_TEST_SUITE_P(
    Refusal, MismatchTest,
    testing::Values(
        Mismatch{"box", "${x_lo} ${x_hi}", "${x_lo} 0.0201",
                 "box x: fluid 0 … 0.02 m, solid 0 … 0.0201 m"},
        Mismatch{"step_ratio", "every ${substeps}", "every 7", "substeps: fluid's scene says"},
        Mismatch{"step", "timestep         ${solid_step}", "timestep 1.7e-5",
                 "coupling interval: fluid"},
        Mismatch{"periodicity", "${boundary_x} ${boundary_y}", "p ${boundary_y}",
                 "boundary x: fluid not periodic, solid periodic"},
        Mismatch{"units", "units            si", "units            cgs",
                 "units: fluid SI, solid cgs"},
        Mismatch{"gravity", "gravity ${gravity} vector", "gravity 9.81 vector",
                 "gravity: fluid (0, -9.8, 0)"},
        Mismatch{"depth", "${z_lo} ${z_hi}", "-0.25 0.25", "depth: fluid 1 m, solid 0.5 m"},
        Mismatch{"density", "equal ${density_max}*${depth}", "equal 2*${density_max}*${depth}",
                 "particle density: fluid's scene says 1250"},
        Mismatch{"radius", "diameter ${diameter_max} density", "diameter 0.002 density",
                 "particle radius"}),
    [](const auto& info) { return info.param.name; });

TEST(Refusal, ThreeDimensionsAgainstTwo) {
  SettlingDisc scene;
  scene.change_script("dimension        ${dimension}", "dimension 3");
  scene.change_script("fix              flat all enforce2d", "");
  expect_end(scene.run("", 1, 50.0), 2,
             {"dimension: fluid 2, solid 3", "lbm | error", "liggghts | error"});
}

TEST(Refusal, ListsEveryDisagreementAtOnce) {
  SettlingDisc scene;
  scene.change_script("every ${substeps}", "every 7");
  scene.change_script("gravity ${gravity} vector", "gravity 9.81 vector");
  scene.change_script("${z_lo} ${z_hi}", "-0.25 0.25");
  expect_end(scene.run("", 2, 50.0), 2, {"substeps:", "gravity:", "depth:", "coupling interval:"});
}

// ---- bad input: exit 2
// -----------------------------------------------------------------------------

TEST(BadInput, OfTheSceneEndsBothWithItsText) {
  SettlingDisc scene;
  scene.change_scene("kinematic_viscosity = 1e-5", "kinematic_viscosity = -1e-5");
  expect_end(scene.run(), 2,
             {"lbm | error | scene.toml:13: fluid.kinematic_viscosity = -1e-05",
              "liggghts | error | the fluid program stopped: scene.toml:13"});
}

TEST(BadInput, MissingSceneFile) {
  SettlingDisc scene;
  expect_end(scene.run("nowhere.toml"), 2, {"lbm | error | nowhere.toml: no such file"});
}

TEST(BadInput, MissingScript) {
  SettlingDisc scene;
  expect_end(scene.run("", 1, 30.0, "-in nowhere.liggghts"), 2,
             {"liggghts | error | nowhere.liggghts: no such file",
              "lbm | error | the solid program stopped"});
}

TEST(BadInput, OptionThatIsNone) {
  SettlingDisc scene;
  expect_end(scene.run("--outt there"), 2,
             {"lbm | error | The following argument was not expected: --outt"});
}

TEST(BadInput, OptionThatIsNoneOfAnyProgram) {
  for (const std::string program : {"lbm", "replay", "trace"})
    expect_end(test::run(test::kBin + "/" + program + " --nonsense", ".", 50.0), 2,
               {program + " | error | ", program + " --help shows what there is"});
}

TEST(BadInput, OutputFolderThatCannotBe) {
  SettlingDisc scene;
  expect_end(scene.run("--out /proc/nowhere"), 2, {"lbm | error | /proc/nowhere"});
}

TEST(BadInput, TraceThatCannotBeWritten) {
  SettlingDisc scene;
  expect_end(scene.run("--record /nowhere/t.h5"), 1, {"cannot open /nowhere/t.h5"});
}

// ---- errors on the way
// -----------------------------------------------------------------------------

TEST(ScriptError, BeforeTheCoupling) {
  SettlingDisc scene;
  scene.change_script("pair_coeff", "pair_coefficient");
  expect_end(scene.run(), 1,
             {"lbm | error | the solid program stopped: ERROR: Unknown command: pair_coefficient"});
}

TEST(ScriptError, BeforeTheCouplingOnThreeRanks) {
  SettlingDisc scene;
  scene.change_script("pair_coeff", "pair_coefficient");
  expect_end(scene.run("", 3), 1, {"Unknown command: pair_coefficient"});
}

TEST(ScriptError, DuringTheRun) {
  SettlingDisc scene;  // the disc leaves the box and LIGGGHTS misses an atom
  scene.change_scene("end_time = 0.04", "end_time = 1.0");
  scene.change_script("then \"fix bottom", "then \"variable no equal 0\" else \"fix bottom");
  scene.change_script("${particle1_y}", "0.000005");
  scene.change_script("thermo           5000",
                      "thermo 100\nthermo_modify lost error\nset atom 1 vy -0.05");
  expect_end(scene.run(), 1, {"lbm | error | the solid program stopped: ERROR: Lost atoms"});
}

TEST(ScriptError, AVariableThatNothingDefinesIsNamed) {
  SettlingDisc scene;
  scene.change_script("peratomtypepair 1 ${contact_stiffness}", "peratomtypepair 1 ${stiffness}");
  expect_end(scene.run(), 1,
             {"Substitution for illegal variable", "nothing defines ${stiffness} (in.liggghts:"});
}

TEST(Numerics, AStateThatIsNotFiniteIsNamed) {
  SettlingDisc scene;
  scene.change_script("run              ${solid_steps_total}",
                      "set atom 1 vx 1e400\nrun ${solid_steps_total}");
  expect_end(scene.run(), 3,
             {"particle 1: velocity is (inf", "liggghts | error | the fluid program stopped"});
}

TEST(Numerics, ANaNInTheStatesOnTheWay) {
  SettlingDisc scene;
  expect_end(test::run(mpirun({kLbm}, {kPeer + " solid nan"}), scene.folder(), 50.0), 3,
             {"lbm | error | particle 4: velocity is (0, nan, 0) at interval 3"});
}

TEST(Numerics, ANaNInTheLoadsIsNamedByTheSolid) {
  SettlingDisc scene;
  const test::TemporaryFolder folder;
  folder.write(
      "in.liggghts",
      "dimension 2\nunits si\natom_style granular\natom_modify map array sort 0 0\nboundary p p "
      "p\nnewton "
      "off\n"
      "communicate single vel yes\nregion box block 0 1 0 1 -0.5 0.5 units box\ncreate_box 1 box\n"
      "neighbor 0.02 bin\ncreate_atoms 1 single 0.5 0.5 0 units box\nset type 1 diameter 0.1 "
      "density 1000\n"
      "pair_style none\ntimestep 1e-3\nfix move all nve/sphere\nfix c all lbm/couple every 10\nrun "
      "1000\n");
  expect_end(
      test::run(mpirun({kPeer + " fluid nan"}, {kLiggghts + " -screen none"}), folder.path(), 50.0),
      3, {"liggghts | error | particle 1: hydrodynamic force is (nan"});
}

TEST(Numerics, AFluidThatGetsTooFastStopsBothWithStepPlaceAndValue) {
  SettlingDisc scene;
  scene.change_scene("velocity_scale = 0.06", "velocity_scale = 0.004");
  scene.change_scene("end_time = 0.04", "end_time = 1.0");
  scene.change_scene("kinematic_viscosity = 1e-5", "kinematic_viscosity = 1e-6");
  expect_end(
      scene.run(), 3,
      {"lbm | error | interval ", "moves at ",
       "fluid.gravity = 9.8 m/s² on the particles can give 0.136 m/s", "set fluid.velocity_scale",
       "liggghts | error | the fluid program stopped: interval"});
}

struct Damage {
  const char *script, *reason;
  int exit_code = 1;
};
class DamageTest : public testing::TestWithParam<Damage> {};

TEST_P(DamageTest, IsNamedAndEndsBoth) {
  SettlingDisc scene;
  const auto& [script, reason, code] = GetParam();
  expect_end(test::run(mpirun({kLbm + " --progress none"}, {kPeer + " solid " + script}),
                       scene.folder(), 50.0),
             code, {std::string("lbm | error | ") + reason});
}
INSTANTIATE_TEST_SUITE_P(
    Frames, DamageTest,
    testing::Values(Damage{"swapped", "the partner runs on a machine of the other byte order"},
                    Damage{"noise", "the partner does not speak the BPLBM protocol"},
                    Damage{"cut", "a states message promises"},
                    Damage{"longer", "a states message promises"},
                    Damage{"shapeless", "particle 4 came without radius and mass at interval 0"},
                    Damage{"twice", "particle 4 came twice at interval 0"}),
    [](const auto& info) { return std::string(info.param.script); });

TEST(Damage, FewerLoadsThanParticles) {
  const test::TemporaryFolder folder;
  expect_end(test::run(mpirun({kPeer + " fluid fewer"},
                              {kLiggghts +
                               " -in " BPLBM_SOURCE_DIR
                               "/tools/engines/conformance/in.liggghts -screen none "
                               "-var boundary_x p -var boundary_y p -var x_lo 0 -var "
                               "x_hi 1 -var y_lo 0 -var y_hi 1 -var z_lo -0.5 -var z_hi "
                               "0.5 -var particles 1 -var particle1_x 0.5 -var "
                               "particle1_y 0.5 -var particle1_vx 0 -var particle1_vy 0 "
                               "-var particle1_interval 0 -var particle1_until -1 -var depth 1 "
                               "-var diameter_max 0.1 -var density_max 1000 -var "
                               "contact_stiffness 1e5 -var solid_step 1e-3 -var substeps "
                               "10 -var solid_steps_total 100"}),
                       folder.path(), 50.0),
             1, {"liggghts | error | fluid rank 0 answered 0 loads for 1 particles"});
}

// And what it counts is held against what it sends.
TEST(Slow, APartnerThatTakesItsTimeIsWaitedFor) {
  SettlingDisc scene;
  const auto job =
      test::run(mpirun({kLbm + " --progress none"}, {kPeer + " solid slow"}), scene.folder(), 50.0);
  expect_end(job, 0, {"counts 3 particles (a clump is one), 1 of them lie in the box"});
}

// No file of lbm's may grow beyond a megabyte, as on a disk that is full.
TEST(FullDisk, EndsBothWithTheReason) {
  SettlingDisc scene;
  scene.change_scene("end_time = 0.04", "end_time = 1.0");
  scene.change_scene("fields_every = 0.05", "fields_every = 0.005");
  const std::string limited =
      "sh " BPLBM_SOURCE_DIR "/tests/support/short_of_disk.sh 1000 " + kLbm + " --progress none";
  const auto job =
      test::run(mpirun({limited}, {kLiggghts + " -screen none"}), scene.folder(), 50.0);
  expect_end(job, 1, {"is the disk full?", "liggghts | error | the fluid program stopped"});
}

/// Runs a job that would last for hours and sends a signal to one of its programs when both have
/// begun to step.
JobResult run_and_kill(const std::string& program, const std::string& signal = "KILL",
                       const std::string& solid = kLiggghts + " -screen none") {
  SettlingDisc scene;
  scene.change_scene("end_time = 0.04", "end_time = 1000.0");
  const std::string job = mpirun({kLbm + " --progress none"}, {solid});
  return test::run("(" + job + ") & job=$!; until [ -s out/probes.csv ]; do sleep 0.1; done; " +
                       "sleep 0.5; pkill -" + signal + " -x -P $job " + program + "; wait $job",
                   scene.folder(), 50.0);
}

// It tells the fluid with its states, whatever the engine.
TEST(Stopped, ASignalToTheSolidAloneEndsBothInGoodOrder) {
  for (const auto& [program, solid] :
       {std::pair{"liggghts", kLiggghts + " -screen none"},
        std::pair{"reference_engin", test::kBin + "/reference_engine"},
        std::pair{"c_engine", test::kBin + "/c_engine"},
        std::pair{"python3", std::string("/usr/bin/python3 " BPLBM_SOURCE_DIR
                                         "/tools/engines/python/engine.py")}}) {
    SCOPED_TRACE(program);
    const JobResult job = run_and_kill(program, "TERM", solid);
    expect_end(job, job.exit_code, {"ending       stopped by a signal"});
    EXPECT_LE(job.exit_code, 1) << job.output;
  }
}

TEST(Lost, KilledFluid) {
  expect_end(run_and_kill("lbm"), 137, {"lbm", "signal 9"});
}

TEST(Lost, KilledSolid) {
  expect_end(run_and_kill("liggghts"), 137,
             {"liggghts", "signal 9", "lbm | error | ended by signal 15"});
}

TEST(Lost, SolidKilledAtItsFirstStep) {
  SettlingDisc scene;
  expect_end(test::run(mpirun({kLbm}, {kPeer + " solid die"}), scene.folder(), 50.0), 137,
             {"signal 9"});
}

TEST(Lost, ASilentSolidIsNamedAfterTheTimeOut) {
  SettlingDisc scene;
  scene.change_scene("timeout = 60.0", "timeout = 1.0");
  expect_end(test::run(mpirun({kLbm}, {kPeer + " solid silent"}), scene.folder(), 50.0), 1,
             {"no answer from solid rank 0 for 1 s while waiting for the states of interval 0"});
}

TEST(Lost, ASilentFluidIsNamedAfterTheTimeOut) {
  SettlingDisc scene;
  scene.change_script("every ${substeps}", "every 10 timeout 1");
  for (const char* name : {"x_lo", "y_lo"})
    scene.change_script(std::string("${") + name + "}", "0");
  for (const auto& [name, value] : {std::pair{"dimension", "2"},
                                    {"x_hi", "0.02"},
                                    {"y_hi", "0.06"},
                                    {"z_lo", "-0.5"},
                                    {"z_hi", "0.5"},
                                    {"boundary_x", "f"},
                                    {"boundary_y", "f"},
                                    {"boundary_z", "p"},
                                    {"walls_x", "1"},
                                    {"walls_y", "1"},
                                    {"diameter_max", "0.0025"},
                                    {"density_max", "1250"},
                                    {"depth", "1"},
                                    {"particle1_x", "0.01"},
                                    {"particle1_y", "0.04"},
                                    {"damping_ratio", "0.5"},
                                    {"contact_stiffness", "2e5"},
                                    {"gravity", "9.8"},
                                    {"gravity_x", "0"},
                                    {"gravity_y", "-1"},
                                    {"solid_step", "1e-5"},
                                    {"solid_steps_total", "1000"}})
    scene.change_script(std::string("${") + name + "}", value);
  expect_end(test::run(mpirun({kPeer + " fluid silent"}, {kLiggghts + " -screen none"}),
                       scene.folder(), 50.0),
             1, {"no answer from fluid rank 0 for 1 s"});
}

/// Whatever the screen is: what LIGGGHTS says of its end reaches the fluid, without a source file.
class ReasonOfTheEnd : public testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(Screens, ReasonOfTheEnd,
                         testing::Values("", "-screen none", "-screen screen.txt"),
                         [](const auto& info) {
                           return std::string(info.param).empty()             ? "terminal"
                                  : std::string(info.param) == "-screen none" ? "none"
                                                                              : "file";
                         });

TEST_P(ReasonOfTheEnd, TravelsToTheFluid) {
  struct End {
    const char *line, *reason;
  };
  for (const auto& [line, reason] :
       {End{"fix breaks all bond/breaks every 100 file no/such/breaks.csv\n",
            "fix bond/breaks: no/such/breaks.csv cannot be written; give a file in a folder that "
            "exists\n"},
        End{"fix odd all bond/create gap -1\n",
            "needs 'gap G', the largest gap in m, at least 0\n"}}) {
    test::SettlingDisc scene;
    scene.set_script(
        test::replaced(scene.script(), "fix              fluid", std::string(line) + "fix fluid"));
    const test::JobResult job = scene.run("", 1, 60.0, GetParam());
    EXPECT_NE(job.exit_code, 0);
    const std::size_t said = job.output.find("lbm | error | the solid program stopped: ERROR");
    ASSERT_NE(said, std::string::npos) << job.output;
    EXPECT_NE(job.output.find(reason, said), std::string::npos) << job.output;
    EXPECT_EQ(job.output.find(BPLBM_SOURCE_DIR "/liggghts_coupling"), std::string::npos);
    EXPECT_EQ(job.output.find("../liggghts_coupling"), std::string::npos) << job.output;
  }
}

// LIGGGHTS' own warnings are not left in its log, and come with the line that they are of.
TEST_P(ReasonOfTheEnd, AndWarningsReachTheTerminal) {
  test::SettlingDisc scene;
  scene.set_script(test::replaced(scene.script(), "fix              fluid",
                                  "thermo_modify norm no\nthermo_style one\nfix fluid"));
  const test::JobResult job = scene.run("", 2, 60.0, GetParam());
  expect_end(job, 0, {});
  const std::string said =
      "liggghts | warning | New thermo_style command, previous thermo_modify settings will be lost "
      "(at the line: thermo_style one)";
  const std::size_t at = job.output.find(said);
  ASSERT_NE(at, std::string::npos) << job.output;
  EXPECT_EQ(job.output.find(said, at + 1), std::string::npos) << "once:\n" << job.output;
  EXPECT_NE(test::read_file(scene.folder() + "/log.liggghts").find(said), std::string::npos);
}

}  // namespace
