// SPDX-License-Identifier: GPL-2.0-or-later
/// The C interface of the library and its Fortran module, by the two engines that use them.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <fstream>
#include <sstream>

#include "tests/support/coupled_job.h"

namespace {

const std::string kDisc = BPLBM_SOURCE_DIR "/cases/settling_disc/scene.toml";
constexpr const char* kShort = "[numerics]\ncells_per_diameter = 10\n[run]\nend_time = 0.2\n";
constexpr const char* kOnTheGround =
    "[particles]\nstart = [[0.01, 0.005], [0.01, 0.03]]\n"
    "[particles.variables]\nparticle2_interval = 480\n"
    "[numerics]\ncells_per_diameter = 10\n"
    "[run]\nend_time = 0.3\ncheckpoint_every = 0.1\n";

std::vector<std::string> engines() {
  std::vector<std::string> found{"c_engine"};
  if (std::ifstream(test::kBin + "/fortran_engine")) found.push_back("fortran_engine");
  return found;
}

class CEngine : public testing::TestWithParam<std::string> {
 protected:
  test::JobResult run(const std::string& options, int fluid_ranks = 1, int solid_ranks = 1) const {
    return test::run(
        test::mpirun(
            {test::kLbm + " " + kDisc + " overlay.toml --progress none " + options, fluid_ranks},
            {test::kBin + "/" + engine_, solid_ranks}),
        folder_.path(), 60.0);
  }
  std::string probes(const std::string& out) const {
    return test::read_file(folder_.path() + "/" + out + "/probes.csv");
  }
  std::string engine_ = GetParam();
  test::TemporaryFolder folder_;
};

/// Rows of numbers of a table without its heading.
std::vector<std::vector<double>> rows(const std::string& csv) {
  std::vector<std::vector<double>> table;
  std::istringstream lines(csv);
  std::string line, cell;
  std::getline(lines, line);
  while (std::getline(lines, line)) {
    table.emplace_back();
    std::istringstream cells(line);
    while (std::getline(cells, cell, ',')) table.back().push_back(std::stod(cell));
  }
  return table;
}

/// @param y, vy  how far the fall of the disc may differ [m], [m/s]
void expect_same_fall(const std::string& a, const std::string& b, double y, double vy) {
  const auto first = rows(a), second = rows(b);
  ASSERT_EQ(first.size(), second.size());
  ASSERT_GT(first.size(), 10U);
  for (std::size_t k = 0; k < first.size(); ++k) {
    EXPECT_NEAR(first[k][3], second[k][3], y) << k;
    EXPECT_NEAR(first[k][5], second[k][5], vy) << k;
  }
}

// The same scheme in another language: round-off, amplified by the fluid over some hundred steps.
TEST_P(CEngine, LetsTheDiscFallAsTheReferenceDoes) {
  folder_.write("overlay.toml", kShort);
  ASSERT_EQ(run("--out own").exit_code, 0);
  engine_ = "reference_engine";
  ASSERT_EQ(run("--out reference").exit_code, 0);
  expect_same_fall(probes("own"), probes("reference"), 1e-12, 1e-10);
}

// The disc lies on the ground when the last checkpoint is written, and another one comes at its
// very interval.
TEST_P(CEngine, GoesOnFromACheckpointToTheBit) {
  folder_.write("overlay.toml", kOnTheGround);
  ASSERT_EQ(run("--out whole").exit_code, 0);
  ASSERT_EQ(run("--out parts --until 0.25").exit_code, 0);
  ASSERT_EQ(run("--out parts --restart").exit_code, 0);
  EXPECT_EQ(probes("parts"), probes("whole"));
  EXPECT_GT(rows(probes("whole")).size(), 100U);
}

INSTANTIATE_TEST_SUITE_P(All, CEngine, testing::ValuesIn(engines()),
                         [](const auto& info) { return info.param; });

class CEngineOnRanks : public CEngine {};

TEST_P(CEngineOnRanks, FallsAlikeAndGoesOnFromACheckpoint) {
  folder_.write("overlay.toml", kShort);
  ASSERT_EQ(run("--out one").exit_code, 0);
  const auto job = run("--out four", 2, 2);
  ASSERT_EQ(job.exit_code, 0) << job.output;
  expect_same_fall(probes("one"), probes("four"), 1e-12, 1e-10);
  folder_.write("overlay.toml", kOnTheGround);
  ASSERT_EQ(run("--out whole", 2, 2).exit_code, 0);
  ASSERT_EQ(run("--out parts --until 0.25", 2, 2).exit_code, 0);
  ASSERT_EQ(run("--out parts --restart", 2, 2).exit_code, 0);
  EXPECT_EQ(probes("parts"), probes("whole"));
}

INSTANTIATE_TEST_SUITE_P(C, CEngineOnRanks, testing::Values("c_engine"),
                         [](const auto& info) { return std::string(info.param); });

// A call that fails leaves its sentence, and the next ones do not hide it.
TEST(CInterface, AloneItSaysWhatToStart) {
  const test::TemporaryFolder folder;
  const auto job =
      test::run("exec env OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1 mpirun -np 1 " +
                    test::kBin + "/c_engine",
                folder.path(), 50.0);
  EXPECT_EQ(job.exit_code, 2) << job.output;
  EXPECT_NE(job.output.find("c_engine | error | no fluid program was started beside it; start: "
                            "mpirun -np 1 lbm scene.toml : -np 1 c_engine"),
            std::string::npos)
      << job.output;
}

}  // namespace
