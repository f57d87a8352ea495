// SPDX-License-Identifier: GPL-2.0-or-later
/// fix lbm/couple against a scripted fluid: impulse, held loads through migration and restart,
/// wrong use; and the real lbm against a scripted solid: late insertion and removal.
#include <gtest/gtest.h>

#include <cmath>
#include <sstream>

#include "tests/support/coupled_job.h"
#include "tests/support/script_parts.h"

namespace {

using test::JobResult;
using test::mpirun;

const std::string kPeer = test::kBin + "/scripted_peer";
constexpr double kMass = 2.0;  // two particles …
constexpr double kRadius = 0.05;
constexpr double kInterval = 1e-2;

/// Two free discs in a periodic box: no gravity, no contact.
std::string script(const std::string& fix = "fix couple all lbm/couple every ${substeps}",
                   const std::string& run = "run ${steps}") {
  return R"(dimension 2
units si
atom_style granular
atom_modify map array
boundary p p p
newton off
communicate single vel yes
processors * 1 1
region box block 0 1 0 1 -0.5 0.5 units box
create_box 1 box
neighbor 0.02 bin
neigh_modify delay 0 every 1
create_atoms 1 single 0.49 0.3 0.0 units box
create_atoms 1 single 0.97 0.7 0.0 units box
set type 1 diameter 0.1 density 254.64790894703253
set atom 1*2 vx 0.5
)" + test::linear_contacts("1e5", "1", "0.3") +
         R"(timestep 1e-3
fix move all nve/sphere
)" + fix +
         "\nfix flat all enforce2d\n" + run + "\n";
}

class FixTest : public testing::Test {
 protected:
  JobResult couple(const std::string& text, const std::string& fluid_script = "impulse 40",
                   int solid_ranks = 1) {
    folder_.write("in.liggghts", text);
    return test::run(mpirun({kPeer + " fluid " + fluid_script},
                            {test::kLiggghts + " -var substeps 10 -var steps 100000", solid_ranks}),
                     folder_.path(), 60.0);
  }
  std::string received() const { return test::read_file(folder_.path() + "/peer.txt"); }
  test::TemporaryFolder folder_;
};

struct StateLine {
  int interval = 0, id = 0;
  double x = 0, vx = 0, vy = 0, omega = 0;
  int epoch = 0;
};
std::vector<StateLine> states(const std::string& received) {
  std::vector<StateLine> lines;
  std::istringstream in(received);
  for (std::string line; std::getline(in, line);) {
    StateLine s;
    if (std::sscanf(line.c_str(), "state %d %d %lf %lf %lf %lf %d", &s.interval, &s.id, &s.x, &s.vx,
                    &s.vy, &s.omega, &s.epoch) == 7)
      lines.push_back(s);
  }
  return lines;
}

// Load k is (k+1) F. After n intervals the momentum is F T n(n+1)/2, exactly if every substep of an
// interval, its first half-kick included, acts with the interval's own load.
void expect_impulse_of_40_intervals(const std::vector<StateLine>& all) {
  ASSERT_EQ(all.size(), 2U * 41);
  const double inertia = 0.5 * kMass * kRadius * kRadius;
  for (const auto& s : all) {
    const double sum = 0.5 * s.interval * (s.interval + 1);
    EXPECT_NEAR(s.vx, 0.5 + 0.25 * sum * kInterval / kMass, 1e-12) << s.interval;
    EXPECT_NEAR(s.vy, -0.5 * sum * kInterval / kMass, 1e-12) << s.interval;
    EXPECT_NEAR(s.omega, 0.125 * sum * kInterval / inertia, 1e-9) << s.interval;
  }
}

TEST_F(FixTest, ImpulseIsTheLoadTimesTheInterval) {
  const auto job = couple(script());
  ASSERT_EQ(job.exit_code, 0) << job.output;
  expect_impulse_of_40_intervals(states(received()));
}

TEST_F(FixTest, AFrozenParticleStaysWhereItIs) {
  for (const std::string hold : {"freeze", "setforce 0.0 0.0 0.0"}) {
    const auto job =
        couple(script("group held id 2\nset atom 2 vx 0.0\n"
                      "fix couple all lbm/couple every 10\nfix hold held " +
                      hold));
    ASSERT_EQ(job.exit_code, 0) << job.output;
    const auto all = states(received());
    ASSERT_EQ(all.size(), 2U * 41);
    for (const auto& s : all)
      if (s.id == 2) {
        EXPECT_EQ(s.x, 0.97) << hold << ' ' << s.interval;
        EXPECT_EQ(s.vy, 0.0) << hold << ' ' << s.interval;
      }
    EXPECT_NE(all.front().vy, all[2 * 40].vy);  // the free one does move
  }
}

TEST_F(FixTest, LaterRunsGoOnAlsoFromTheMiddleOfAnInterval) {
  for (const std::string runs : {"run 100\nrun 300", "run 0\nrun 55\nrun ${steps}",
                                 "run 400 every 37 NULL", "run 63\nrun 400 upto every 50 NULL"}) {
    const auto job = couple(script("fix couple all lbm/couple every 10", runs));
    ASSERT_EQ(job.exit_code, 0) << runs << job.output;
    expect_impulse_of_40_intervals(states(received()));
  }
}

/// Epochs of a particle, one each interval.
std::vector<int> epochs(const std::vector<StateLine>& all, int id) {
  std::vector<int> epochs;
  for (const auto& s : all)
    if (s.id == id) epochs.push_back(s.epoch);
  return epochs;
}

// delete_atoms gives the id of the first particle to the second: the fluid must not take the two
// for one. Also on two ranks, and where the particle that keeps its id is moved by the script.
TEST_F(FixTest, AnIdThatPassesToAnotherParticleGetsAnotherEpoch) {
  const std::string fix = "fix couple all lbm/couple every 10";
  const std::string without = "run 20\ngroup gone id 1\ndelete_atoms group gone\nrun ${steps}";
  for (const int ranks : {1, 2}) {
    const auto job = couple(script(fix, without), "impulse 5", ranks);
    ASSERT_EQ(job.exit_code, 0) << job.output;
    EXPECT_EQ(epochs(states(received()), 1), (std::vector<int>{0, 0, 0, 3, 3, 3})) << received();
    EXPECT_EQ(epochs(states(received()), 2), (std::vector<int>{0, 0, 0})) << received();
  }
}

TEST_F(FixTest, AParticleThatTheScriptMovesBeginsAnew) {
  const std::string fix = "fix couple all lbm/couple every 10\ngroup second id 2";
  const std::string moved =
      "run 25\ndisplace_atoms second move 0.0 0.2 0.0 units box\nrun ${steps}";
  const auto job = couple(script(fix, moved), "impulse 5");
  ASSERT_EQ(job.exit_code, 0) << job.output;
  EXPECT_EQ(epochs(states(received()), 1), (std::vector<int>{0, 0, 0, 0, 0, 0})) << received();
  EXPECT_EQ(epochs(states(received()), 2), (std::vector<int>{0, 0, 0, 3, 3, 3})) << received();
}

TEST_F(FixTest, HeldLoadsMigrateBetweenRanks) {
  const auto one = couple(script());
  ASSERT_EQ(one.exit_code, 0) << one.output;
  const auto a = states(received());
  const auto two = couple(script(), "impulse 40", 2);
  ASSERT_EQ(two.exit_code, 0) << two.output;
  const auto b = states(received());
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) {
    EXPECT_EQ(a[i].id, b[i].id);
    // wrapped or not, it is the same place
    EXPECT_NEAR(std::remainder(a[i].x - b[i].x, 1.0), 0.0, 1e-12);
    EXPECT_NEAR(a[i].vx, b[i].vx, 1e-12);
  }
  EXPECT_GT(a.back().x + 1.0, 0.6);  // it did cross the border between the ranks at x = 0.5
}

TEST_F(FixTest, TheScriptGoesOnAfterTheFluidsEndAndWritesARestartWithTheHeldLoads) {
  const std::string dump =
      "\ndump d all custom 1 held.txt id f_couple[1] f_couple[6]\n"
      "dump_modify d sort id format \"%d %.17g %.17g\"\n";
  auto text =
      test::replaced(script(), "run ${steps}",
                     dump + "run ${steps}\nwrite_restart held.restart\nprint \"script went on\"");
  auto job = couple(text);
  ASSERT_EQ(job.exit_code, 0) << job.output;
  EXPECT_NE(job.output.find("script went on"), std::string::npos);
  const auto last_dump = [&] {
    const std::string all = test::read_file(folder_.path() + "/held.txt");
    return all.substr(all.rfind("ITEM: ATOMS"));
  };
  const std::string before = last_dump();
  EXPECT_NE(before.find("1 10 5"), std::string::npos) << before;  // 40 × (0.25, 0.125)

  // Read back: setup sends the states and receives new loads, so look at the held ones by a fix of
  // the same style before any run.
  const std::string again =
      test::replaced(script(), "region box block 0 1 0 1 -0.5 0.5 units box", "");
  text = test::replaced(again, "create_box 1 box", "read_restart held.restart");
  text = text.substr(0, text.find("create_atoms")) + text.substr(text.find("fix kn"));
  text = test::replaced(text, "neighbor 0.02 bin", "");
  text = test::replaced(text, "run ${steps}",
                        "variable a equal f_couple[1][1]\nvariable b equal f_couple[1][6]\n"
                        "print \"restored ${a} ${b}\"\nrun ${steps}");
  text = test::replaced(text, "processors * 1 1", "");
  job = couple(text);
  EXPECT_NE(job.output.find("restored 10 5"), std::string::npos) << job.output;
}

void expect_error(const JobResult& job, const std::string& words, int exit_code = 1) {
  EXPECT_FALSE(job.timed_out) << job.output;
  EXPECT_EQ(job.exit_code, exit_code) << job.output;
  EXPECT_NE(job.output.find(words), std::string::npos) << job.output;
}

TEST_F(FixTest, WrongUseIsNamed) {
  expect_error(couple(script("fix couple all lbm/couple every 0")),
               "'every 0': give a whole number of at least 1");
  expect_error(couple(script("fix couple all lbm/couple every 10x")),
               "'every 10x': give a whole number");
  expect_error(couple(script("fix couple all lbm/couple every 10 timeout 3s")),
               "'timeout 3s': give a positive number of seconds");
  expect_error(couple(script("fix couple all lbm/couple evry 10")), "'evry' is no keyword");
  expect_error(couple(script("fix couple all lbm/couple every")), "'every' has no value");
  expect_error(couple(script("fix couple all lbm/couple every 10 timeout -3")),
               "'timeout -3': give a positive number");
  expect_error(couple(script("fix flat0 all enforce2d\nfix couple all lbm/couple every 10")),
               "must stand before fix flat0 enforce2d");
  expect_error(
      couple(script("fix couple all lbm/couple every 10\nfix more all lbm/couple every 10")),
      "only one fix lbm/couple");
}

TEST_F(FixTest, DiscsBesideEachOtherInDepthAreNamed) {
  expect_error(
      couple(script("create_atoms 1 single 0.5 0.5 0.2 units box\nset atom 3 diameter 0.1\n"
                    "fix couple all lbm/couple every 10")),
      "in two dimensions all lie in one plane");
}

TEST_F(FixTest, ParticlesThatNothingMovesAreWarnedOf) {
  const std::string warning = "no fix of the script moves its particles";
  const std::string fix = "fix couple all lbm/couple every 10";
  const auto moving = couple(script(fix, "run 55"));
  EXPECT_EQ(moving.output.find(warning), std::string::npos) << moving.output;
  const auto still = couple(script("unfix move\n" + fix, "run 55"));
  EXPECT_EQ(still.exit_code, 0) << still.output;
  EXPECT_NE(still.output.find(warning), std::string::npos) << still.output;
}

TEST_F(FixTest, ALaterRunThatCannotGoOnIsNamed) {
  const std::string fix = "fix couple all lbm/couple every 10";
  for (const std::string run : {"run ${steps}\nrun 10", "run 500 every 50 NULL"})
    expect_error(couple(script(fix, run)), "no run may follow");
  expect_error(couple(script(fix, "run 10\nreset_timestep 0\nrun 10")),
               "the step was 10 at the end of the last run and is 0 now");
  expect_error(couple(script(fix, "run 10\ntimestep 2e-3\nrun 10")),
               "the time step was 0.001 s in the last run and is 0.002 s now");
  expect_error(couple(script(fix, "run 10\nunfix couple\nunfix flat\n" + fix + "\nrun 10")),
               "was removed and made anew");
}

TEST_F(FixTest, AScriptThatEndsEarlySaysGoodbye) {
  const auto job = couple(script("fix couple all lbm/couple every 10", "run 55"));
  EXPECT_EQ(job.exit_code, 0) << job.output;
  EXPECT_NE(received().find("goodbye: its script ended before the fluid's end time"),
            std::string::npos)
      << received();
}

TEST_F(FixTest, AScriptWithoutTheFixSaysSo) {
  const auto job = couple(script("", "run 10"));
  EXPECT_NE(
      job.output.find("left before the coupling began: its script ended without fix lbm/couple"),
      std::string::npos)
      << job.output;
  EXPECT_EQ(job.exit_code, 1);
  EXPECT_EQ(job.output.find("no answer"), std::string::npos) << job.output;  // nobody waited
}

TEST_F(FixTest, RecordsOnItsSideToo) {
  const auto job = couple(script("fix couple all lbm/couple every ${substeps} record solid.h5"));
  ASSERT_EQ(job.exit_code, 0) << job.output;
  const auto info = test::run(test::kBin + "/trace info solid.h5", folder_.path(), 50.0);
  EXPECT_EQ(info.exit_code, 0) << info.output;
  EXPECT_NE(info.output.find("recorded by the solid program"), std::string::npos) << info.output;
  EXPECT_NE(info.output.find("intervals 0 … 40"), std::string::npos) << info.output;
}

TEST_F(FixTest, AnEmptyBoxIsLegal) {
  std::string text = script();  // LIGGGHTS' granular pair styles want a particle: none here
  text = text.substr(0, text.find("create_atoms")) + text.substr(text.find("timestep"));
  text = test::replaced(text, "atom_modify map array", "atom_modify map array sort 0 0");
  const auto job = couple(text, "impulse 5");
  EXPECT_EQ(job.exit_code, 0) << job.output;
  EXPECT_TRUE(states(received()).empty());
}

// Both real programs: without its floor the disc falls out of the box, LIGGGHTS deletes it, and the
// fluid goes on with no particle.
TEST(Removal, ADiscThatFallsOutOfTheBoxIsGoneAndTheRunGoesOn) {
  test::SettlingDisc scene;
  scene.change_scene("end_time = 0.04", "end_time = 1.0");
  scene.change_script("${particle1_y}", "0.000005");
  scene.change_script("then \"fix bottom", "then \"variable no equal 0\" else \"fix bottom");
  scene.change_script("thermo           5000",
                      "thermo 5000\nthermo_modify lost ignore\nset atom 1 vy -0.05");
  const auto job = scene.run("--record all.h5");
  ASSERT_EQ(job.exit_code, 0) << job.output;
  EXPECT_NE(job.output.find("complete"), std::string::npos) << job.output;
  const auto info = test::run(test::kBin + "/trace info all.h5", scene.folder(), 50.0);
  EXPECT_NE(info.output.find("0 … 1 particles"), std::string::npos) << info.output;
}

// The real fluid: nothing in the box, a particle at interval 5, another at 8 that leaves at 20.
TEST(LateInsertion, AnEmptyBoxFillsAndEmptiesAgain) {
  test::SettlingDisc scene;
  // the scripted solid holds its particles, as no free particle is: no virtual mass for them
  scene.change_scene("timeout = 60.0", "timeout = 60.0\nvirtual_mass = 0.0");
  const auto job = test::run(mpirun({test::kLbm + " --record all.h5"}, {kPeer + " solid insert"}),
                             scene.folder(), 60.0);
  ASSERT_EQ(job.exit_code, 0) << job.output;
  const std::string loads = test::read_file(scene.folder() + "/peer.txt");
  const std::string buoyancy = "0.0481";  // rho_f pi R² g of a disc at rest in a fluid at rest
  EXPECT_NE(loads.find("load 5 4 " + buoyancy), std::string::npos) << loads;
  EXPECT_NE(loads.find("load 8 2 " + buoyancy), std::string::npos);
  EXPECT_NE(loads.find("load 19 2 " + buoyancy), std::string::npos);
  EXPECT_EQ(loads.find("load 20 2"), std::string::npos);
  EXPECT_NE(loads.find("load 20 4"), std::string::npos);
  const auto info = test::run(test::kBin + "/trace info all.h5", scene.folder(), 50.0);
  EXPECT_NE(info.output.find("0 … 2 particles"), std::string::npos) << info.output;
}

}  // namespace
