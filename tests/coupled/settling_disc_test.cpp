// SPDX-License-Identifier: GPL-2.0-or-later
/// The coupled scene with the real programs: result, ranks, momentum, order of events.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <sstream>

#include "protocol/transport/trace_compare.h"
#include "tests/support/coupled_job.h"

namespace {

using test::SettlingDisc;

std::vector<protocol::IntervalRecord> recorded(const SettlingDisc& scene, const std::string& file) {
  return protocol::timeline(protocol::Trace(scene.folder() + "/" + file));
}

void expect_success(const test::JobResult& job) {
  EXPECT_FALSE(job.timed_out) << job.output;
  ASSERT_EQ(job.exit_code, 0) << job.output;
}

// Re_max = rho_s d U / mu is 17.27 … 17.42 in the literature (Glowinski et al. 2001, Wan and Turek
// 2006); 3 % of the middle is the tolerance of the scene, at ten cells a diameter as well.
TEST(SettlingDiscCoupled, ReachesTheLiteraturesReynoldsNumberAndRests) {
  SettlingDisc scene;
  scene.change_scene("end_time = 0.04", "end_time = 1.0");
  expect_success(scene.run("--record all.h5"));
  double fastest = 0.0;
  const auto record = recorded(scene, "all.h5");
  for (const auto& r : record) fastest = std::max(fastest, -r.states[0].v[1]);
  const double reynolds = 1250.0 * 0.0025 * fastest / (1000.0 * 1e-5);
  EXPECT_NEAR(reynolds, 17.345, 0.03 * 17.345);
  EXPECT_NEAR(record.back().states[0].x[1], 0.00125, 0.01 * 0.00125);  // on the floor
  EXPECT_LT(std::abs(record.back().states[0].v[1]), 0.001 * fastest);  // at rest
  EXPECT_NE(scene.output("summary.json").find("\"ending\": \"complete\""), std::string::npos);
}

// Subcycling changes neither the fall nor the fluid's cost; 1 %: the criterion of the hard case.
TEST(SettlingDiscCoupled, OneToFiftySubstepsFallAlike) {
  std::vector<double> speeds;
  for (const int substeps : {1, 5, 20, 50}) {
    SettlingDisc scene;
    scene.change_scene("end_time = 0.04", "end_time = 0.4");
    scene.change_scene("contact_stiffness = 2.0e5", "contact_stiffness = 2.0e2");  // allows one
    scene.change_scene("[coupling]", "[coupling]\nsubsteps = " + std::to_string(substeps));
    expect_success(scene.run("--record all.h5"));
    speeds.push_back(recorded(scene, "all.h5").back().states[0].v[1]);
  }
  EXPECT_LT(speeds[0], -0.05);
  for (const double speed : speeds) EXPECT_NEAR(speed / speeds[0], 1.0, 0.01);
}

TEST(SettlingDiscCoupled, IsWarnedOfOnceWhenItGetsFast) {
  SettlingDisc scene;
  scene.change_scene("velocity_scale = 0.06", "velocity_scale = 0.04");  // 0.14 C in the end
  scene.change_scene("end_time = 0.04", "end_time = 0.4");
  const auto job = scene.run();
  expect_success(job);
  const std::string warning = "C, above 0.1: compressibility error; a run stops at 0.2.";
  EXPECT_NE(job.output.find("set fluid.velocity_scale"), std::string::npos) << job.output;
  const std::size_t first = job.output.find(warning);
  ASSERT_NE(first, std::string::npos) << job.output;
  EXPECT_EQ(job.output.find(warning, first + 1), std::string::npos) << job.output;
}

TEST(SettlingDiscCoupled, SameTrajectoryWithOneTwoAndThreeSolidRanks) {
  SettlingDisc scene;
  // started off centre and near a border of the rank grid, so that it migrates and drifts sideways
  scene.change_scene("[[0.01, 0.04]]", "[[0.0085, 0.0402]]");
  scene.change_scene("end_time = 0.04", "end_time = 0.2");
  for (const int ranks : {1, 2, 3}) {
    scene.change_script(
        ranks == 1 ? "newton           off"
                   : "processors       * " + std::to_string(ranks - 1) + " 1\nnewton           off",
        "processors       * " + std::to_string(ranks) + " 1\nnewton           off");
    expect_success(scene.run("--record " + std::to_string(ranks) + ".h5", ranks));
  }
  const auto one = recorded(scene, "1.h5");
  EXPECT_NEAR(one.back().head.time, 0.2, 1e-9);
  EXPECT_LT(one.back().states[0].x[1], 0.04);  // crossed the border at y = 0.04 of three ranks
  for (const char* file : {"2.h5", "3.h5"}) {
    const auto other = recorded(scene, file);
    ASSERT_EQ(other.size(), one.size());
    protocol::TraceComparison compare(one);
    for (std::size_t k = 0; k < one.size(); ++k) {
      compare.states(one[k].head.interval, one[k].states, other[k].states);
      compare.loads(one[k].head.interval, one[k].loads, other[k].loads);
    }
    EXPECT_LE(compare.largest(), 1e-12) << file << ": " << compare.text();
  }
}

// The impulse that the disc receives in an interval is exactly load plus weight, times the
// interval: no half-step may act with an old load.
TEST(SettlingDiscCoupled, MomentumOfTheDiscChangesByLoadTimesInterval) {
  SettlingDisc scene;
  expect_success(scene.run("--record all.h5"));
  const auto record = recorded(scene, "all.h5");
  ASSERT_GT(record.size(), 90U);
  const double mass = record[0].shapes[0].mass;
  EXPECT_NEAR(mass, 1250.0 * std::numbers::pi * 0.00125 * 0.00125, 1e-12);
  const double interval = record[1].head.time - record[0].head.time;
  for (std::size_t k = 0; k + 1 < record.size(); ++k) {
    const double gained = mass * (record[k + 1].states[0].v[1] - record[k].states[0].v[1]);
    const double given = (record[k].loads[0].force[1] - 9.8 * mass) * interval;
    // relative to the weight's impulse, the largest single term
    EXPECT_NEAR(gained, given, 1e-12 * 9.8 * mass * interval) << "interval " << k;
  }
}

TEST(SettlingDiscCoupled, FirstStateIsTheStartAndTheLastCarriesItsFlag) {
  SettlingDisc scene;
  expect_success(scene.run("--record all.h5"));
  const auto record = recorded(scene, "all.h5");
  EXPECT_EQ(record.front().head.interval, 0);
  EXPECT_EQ(record.front().states[0].x, (protocol::Vec3{0.01, 0.04, 0.0}));
  for (std::size_t k = 0; k + 1 < record.size(); ++k) {
    EXPECT_EQ(record[k].head.flags & protocol::kLast, 0U);
    EXPECT_EQ(record[k].loads.size(), 1U);
    EXPECT_EQ((record[k].load_flags & protocol::kStop) != 0, k + 2 == record.size());
  }
  EXPECT_NE(record.back().head.flags & protocol::kLast, 0U);
  EXPECT_TRUE(record.back().loads.empty());
}

/// Numbers of an array in a frame of the fields.
std::vector<double> frame_values(const SettlingDisc& scene, const std::string& path) {
  const auto dump = test::run("h5dump -y -w 1 -d " + path + " out/fields.h5 | grep -E '^ +[-0-9n]'",
                              scene.folder(), 50.0);
  std::vector<double> values;
  std::istringstream lines(dump.output);
  for (std::string line; std::getline(lines, line);) values.push_back(std::stod(line));
  return values;
}

std::vector<std::vector<double>> probe_rows(const SettlingDisc& scene) {
  std::istringstream lines(scene.output("probes.csv"));
  std::string line, number;
  std::getline(lines, line);
  std::vector<std::vector<double>> rows;
  while (std::getline(lines, line)) {
    rows.emplace_back();
    std::istringstream numbers(line);
    while (std::getline(numbers, number, ',')) rows.back().push_back(std::stod(number));
  }
  return rows;
}

// Fluid and particles of a frame belong to one time, the first one to t = 0; the disc shows its own
// velocity, and no pressure. The last row of the probes has the load of the last interval.
TEST(SettlingDiscCoupled, OutputShowsTheStateOfItsTime) {
  SettlingDisc scene;
  scene.change_scene("fields_every = 0.05", "fields_every = 0.008");
  scene.change_scene("probe_every = 0.001", "probe_every = 0.004");
  expect_success(scene.run("--record all.h5"));
  const auto record = recorded(scene, "all.h5");
  const auto rows = probe_rows(scene);
  ASSERT_EQ(rows.size(), 11U);
  const double interval = record[1].head.time;
  for (int i = 0; i <= 10; ++i) {  // the first state at or after the time
    EXPECT_GE(rows[i][0], 0.004 * i - 1e-9);
    EXPECT_LT(rows[i][0], 0.004 * i + interval);
  }
  for (const double value : rows.back()) EXPECT_TRUE(std::isfinite(value));
  const double last_load = record[record.size() - 2].loads[0].force[1];
  EXPECT_NEAR(rows.back()[8], last_load, 1e-9 * std::abs(last_load));  // twelve digits are written
  for (const double u : frame_values(scene, "/frame000000/velocity")) EXPECT_EQ(u, 0.0);
  const auto solid = frame_values(scene, "/frame000005/solid_fraction");
  const auto velocity = frame_values(scene, "/frame000005/velocity");
  const auto pressure = frame_values(scene, "/frame000005/pressure");
  const auto disc = frame_values(scene, "/frame000005/particles");
  ASSERT_EQ(velocity.size(), 3 * solid.size());
  ASSERT_EQ(disc.size(), 8U);
  // vy of the same time; six digits are shown
  EXPECT_NEAR(disc[5], rows.back()[5], 1e-5 * std::abs(disc[5]));
  int whole = 0;
  for (std::size_t i = 0; i < solid.size(); ++i) {
    EXPECT_EQ(std::isnan(pressure[i]), solid[i] == 1.0) << i;
    if (solid[i] < 1.0) continue;
    ++whole;  // single precision; the disc hardly turns
    EXPECT_NEAR(velocity[3 * i + 1], disc[5], 1e-3 * std::abs(disc[5])) << i;
  }
  EXPECT_GT(whole, 50);
}

TEST(SettlingDiscCoupled, SeveralFluidStepsAnIntervalGiveTheSameMotion) {
  SettlingDisc scene;
  scene.change_scene("end_time = 0.04", "end_time = 0.12");
  expect_success(scene.run("--record one.h5"));
  scene.change_scene("timeout = 60.0", "fluid_steps = 3\ntimeout = 60.0");
  expect_success(scene.run("--record three.h5"));
  const auto one = recorded(scene, "one.h5"), three = recorded(scene, "three.h5");
  const double fallen_one = 0.04 - one.back().states[0].x[1];
  const double fallen_three = 0.04 - three.back().states[0].x[1];
  EXPECT_NEAR(fallen_three / fallen_one, 1.0, 0.01);  // subcycling: below 1 %
}

TEST(SettlingDiscCoupled, TheLiteralCommandOfASceneFolderWorks) {
  SettlingDisc scene;
  const auto job =
      test::run("export PATH=" + test::kBin + ":$PATH; " + test::mpirun({"lbm"}, {"liggghts"}),
                scene.folder(), 60.0);
  expect_success(job);
  EXPECT_NE(job.output.find("complete"), std::string::npos);
}

TEST(SettlingDiscCoupled, VariablesOfTheCommandLineComeFirst) {
  SettlingDisc scene;  // the fluid offers x = 0.01 m
  expect_success(scene.run("--record own.h5", 1, 60.0, "-screen none -var particle1_x 0.009"));
  expect_success(scene.run("--force --record offered.h5"));
  EXPECT_EQ(recorded(scene, "own.h5").front().states[0].x[0], 0.009);
  EXPECT_EQ(recorded(scene, "offered.h5").front().states[0].x[0], 0.01);
}

TEST(SettlingDiscCoupled, TheVariablesThatCheckPrintsAreThoseOfARun) {
  SettlingDisc scene;
  const auto line =
      test::run(test::kLbm + " check --liggghts-vars scene.toml", scene.folder(), 50.0);
  ASSERT_EQ(line.exit_code, 0) << line.output;
  std::string variables = line.output;
  variables.erase(variables.find_last_not_of('\n') + 1);
  EXPECT_NE(variables.find("-var particle1_x 0.01 "), std::string::npos) << variables;
  expect_success(scene.run("--record given.h5", 1, 60.0, "-screen none " + variables));
  expect_success(scene.run("--force --record offered.h5"));
  const auto given = recorded(scene, "given.h5"), offered = recorded(scene, "offered.h5");
  ASSERT_EQ(given.size(), offered.size());
  EXPECT_EQ(given.back().states[0].x, offered.back().states[0].x);
}

}  // namespace
