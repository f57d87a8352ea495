// SPDX-License-Identifier: GPL-2.0-or-later
/// When output is due, and that a run writes what belongs to a time at that time.
#include "lbm_solver/coupling/output_times.h"

#include <gtest/gtest.h>
#include <omp.h>

#include <cmath>
#include <sstream>

#include "lbm_solver/coupling/run.h"
#include "lbm_solver/io/scene_reader.h"
#include "protocol/transport/hdf5_file.h"
#include "tests/support/job.h"
#include "tests/unit/lbm_solver/scene_files.h"

namespace {

using namespace lbm;

// Adding 0.1 up ten times gives less than 1: times are found from whole numbers.
TEST(OutputTimes, EveryMultipleOnceWhateverTheRounding) {
  for (const std::int64_t steps : {10, 70, 1000, 12340, 33333330, 1000000000})
    for (const double end : {1.0, 0.3, 60.0, 7.7}) {
      const double interval = end / static_cast<double>(steps);
      const OutputTimes times(end / 10.0, interval);
      std::int64_t state = 0;
      for (int count = 0; count <= 10; ++count) {
        EXPECT_EQ(times.next(state), count * (steps / 10)) << steps << ' ' << end;
        state = times.next(state) + 1;
      }
    }
}

TEST(OutputTimes, FirstStateAtOrAfterATimeThatIsNoMultiple) {
  const OutputTimes times(0.1, 0.03);  // 3.33 intervals
  std::vector<std::int64_t> due;
  for (std::int64_t state = 0; state <= 14; ++state)
    if (times.due(state)) due.push_back(state);
  EXPECT_EQ(due, (std::vector<std::int64_t>{0, 4, 7, 10, 14}));
  EXPECT_EQ(times.next(5), 7);
}

TEST(OutputTimes, EveryStateWhereLessThanAnIntervalIsAskedFor) {
  for (const double every : {0.0, 1e-4, 1e-3})
    for (std::int64_t state = 0; state < 50; ++state)
      EXPECT_TRUE(OutputTimes(every, 1e-3).due(state)) << every << ' ' << state;
}

TEST(OutputTimes, NeverAgainWhereTheTimeIsLongerThanAnyRun) {
  for (const double every : {1e12, 1e17, 1e18, 1e300}) {
    const OutputTimes times(every, 1e-3);
    EXPECT_TRUE(times.due(0)) << every;
    for (const std::int64_t state : {1, 2, 1000, 1000000000})
      EXPECT_GE(times.next(state), 999'999'999'999'999) << every;
  }
  EXPECT_EQ(first_state(1e300, 1e-3), first_state(1e200, 1e-3));
}

TEST(OutputTimes, FirstStateOfATime) {
  EXPECT_EQ(first_state(1.1, 0.1), 11);  // 1.1 / 0.1 is 11.000000000000002
  EXPECT_EQ(first_state(0.7, 0.1), 7);   // 0.7 / 0.1 is 6.999999999999999
  EXPECT_EQ(first_state(0.31, 0.1), 4);
  EXPECT_EQ(first_state(0.0, 0.1), 0);
  EXPECT_EQ(first_state(1e9 * 0.1, 0.1), 1000000000);
}

/// A fluid of 10 × 8 cells that a force sets in motion from rest, with u = g t.
constexpr double kGravity = 0.02;  // m/s²
const std::string kScene = test::small_fluid("1.0", "body_force = [0.02, 0.0]\n", R"([output]
fields_every = 0.1
probe_every = 0.1
points = [[0.033, 0.041]]
)");

/// Runs a scene alone. @return its table `name`, a line of numbers each, without the columns
std::vector<std::vector<double>> run(const test::TemporaryFolder& folder, const std::string& text,
                                     const std::string& name, RunOptions options = {}) {
  const Scene scene = read_scene({folder.write("scene.toml", text)});
  const Plan plan = make_plan(scene);
  options.out = folder.path();
  Log log;
  const int threads = omp_get_max_threads();
  omp_set_num_threads(1);  // a box so small waits for its threads only
  run_alone(scene, plan, Decomposition(plan.domain), options, log);
  omp_set_num_threads(threads);
  std::istringstream table(test::read_file(folder.path() + "/" + name));
  std::string line, number;
  std::getline(table, line);
  std::vector<std::vector<double>> rows;
  while (std::getline(table, line)) {
    rows.emplace_back();
    std::istringstream numbers(line);
    while (std::getline(numbers, number, ',')) rows.back().push_back(std::stod(number));
  }
  return rows;
}

/// Time of each frame, and velocity along x of its first cell.
std::vector<std::pair<double, double>> frames(const test::TemporaryFolder& folder) {
  using protocol::hdf5::Handle;
  const Handle file =
      protocol::hdf5::open_file(folder.path() + "/fields.h5", protocol::hdf5::Open::Read);
  std::vector<std::pair<double, double>> all;
  for (;;) {
    const std::string name = fmt::format("frame{:06}", all.size());
    if (H5Lexists(file, name.c_str(), H5P_DEFAULT) <= 0) return all;
    const Handle group(H5Gopen2(file, name.c_str(), H5P_DEFAULT), H5Gclose, "open " + name);
    const Handle set(H5Dopen2(group, "velocity", H5P_DEFAULT), H5Dclose, "open velocity");
    std::vector<double> u(10 * 8 * 3);
    H5Dread(set, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, u.data());
    all.emplace_back(protocol::hdf5::real_attribute(group, "time"), u[0]);
  }
}

TEST(OutputOfAFluidAlone, ShowsTheStateOfItsTime) {
  const test::TemporaryFolder folder;
  const auto points = run(folder, kScene, "points.csv");
  ASSERT_EQ(points.size(), 11U);
  const auto pictures = frames(folder);
  ASSERT_EQ(pictures.size(), 11U);
  for (int i = 0; i <= 10; ++i) {
    EXPECT_NEAR(points[i][0], 0.1 * i, 1e-12);
    EXPECT_NEAR(points[i][4], kGravity * 0.1 * i, 1e-11) << i;  // twelve digits are written
    EXPECT_NEAR(pictures[i].first, 0.1 * i, 1e-12);
    EXPECT_NEAR(pictures[i].second, kGravity * 0.1 * i, 1e-8) << i;  // single precision
  }
}

TEST(OutputOfAFluidAlone, FirstFrameIsTheInitialState) {
  const test::TemporaryFolder folder;
  const std::string scene = test::replaced(kScene, "[run]",
                                           "[initial]\nkind = \"uniform\"\n"
                                           "velocity = [0.05, 0.0]\n[run]");
  const auto points = run(folder, scene, "points.csv");
  EXPECT_NEAR(points[0][4], 0.05, 1e-13);
  EXPECT_NEAR(frames(folder)[0].second, 0.05, 1e-8);
}

// An obstacle's row is the mean since the row before: none at t = 0, and none over a single step.
TEST(OutputOfAFluidAlone, RowsOfObstaclesEndAtTheirTimes) {
  const test::TemporaryFolder folder;
  const std::string scene = test::replaced(
      kScene, "[run]", "[[obstacle]]\ncentre = [0.05, 0.04]\ndiameter = 0.04\n[run]");
  const auto rows = run(folder, scene, "obstacles.csv");
  ASSERT_EQ(rows.size(), 10U);
  for (int i = 0; i < 10; ++i) EXPECT_NEAR(rows[i][0], 0.1 * (i + 1), 1e-12);
}

// Obstacles have the numbers of the scene, blocks among them; in steady flow their loads add up to
// what drives: rho g × area of the box × depth, as each load holds rho g V of its obstacle.
TEST(OutputOfAFluidAlone, NumbersObstaclesAsTheSceneDoes) {
  const test::TemporaryFolder folder;
  const std::string scene =
      test::replaced(test::replaced(kScene, "end_time = 1.0", "end_time = 30.0"), "[run]",
                     "[[obstacle]]\nfrom = [0.01, 0.02]\nto = [0.03, 0.05]\n"
                     "[[obstacle]]\ncentre = [0.07, 0.04]\ndiameter = 0.03\n"
                     "[[obstacle]]\nfrom = [0.04, 0.0]\nto = [0.05, 0.01]\n[run]");
  const auto rows = run(folder, scene, "obstacles.csv");
  ASSERT_GE(rows.size(), 6U);
  double sum = 0.0;
  for (int number : {1, 2, 3}) {
    const auto& row = rows[rows.size() - 4 + number];
    EXPECT_EQ(row[1], number);
    EXPECT_GT(row[2], 0.0);
    sum += row[2];
  }
  const double drive = 1000.0 * kGravity * 0.1 * 0.08;
  EXPECT_NEAR(sum, drive, 1e-6 * drive);
}

// A run that goes on from a checkpoint, which lies on and between the times of output.
TEST(OutputOfAFluidAlone, IsTheSameAfterARestart) {
  const std::string obstacle =
      "[[obstacle]]\ncentre = [0.05, 0.04]\ndiameter = 0.04\n[run]\ncheckpoint_every = ";
  for (const char* every : {"0.2", "0.27"}) {
    const std::string scene = test::replaced(kScene, "[run]", obstacle + every);
    const test::TemporaryFolder whole, parts;
    run(whole, scene, "obstacles.csv");
    run(parts, scene, "obstacles.csv", {.until = 0.65});
    run(parts, scene, "obstacles.csv", {.restart = "checkpoint"});
    for (const char* name : {"/obstacles.csv", "/points.csv"})
      EXPECT_EQ(test::read_file(parts.path() + name), test::read_file(whole.path() + name));
    EXPECT_EQ(frames(parts), frames(whole));
  }
}

}  // namespace
