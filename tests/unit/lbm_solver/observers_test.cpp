// SPDX-License-Identifier: GPL-2.0-or-later
/// What watches a run: when it looks, what it stops, what it charges; and the tables that go on.
#include "lbm_solver/coupling/observers.h"

#include <gtest/gtest.h>

#include <fmt/format.h>

#include <limits>
#include <thread>

#include "lbm_solver/base/errors.h"
#include "lbm_solver/io/scene_reader.h"
#include "tests/support/job.h"
#include "tests/unit/lbm_solver/scene_files.h"

namespace {

using namespace lbm;
using test::read_file;

const std::string kScene = test::small_fluid("10.0");

/// A fluid alone at rest, with its observers, in a folder of its own.
class ObserversTest : public testing::Test {
 protected:
  void watch(const std::string& more = "") {
    scene_ = read_scene({folder_.write("scene.toml", kScene + more)});
    plan_ = make_plan(scene_);
    fluid_.emplace(make_fluid(scene_, plan_));
    log_.emplace(folder_.path(), Log::Progress::None);
    observers_.emplace(scene_, plan_, Decomposition(plan_.domain), folder_.path(), *log_);
  }
  /// The fluid moves along x with this part of C in one cell.
  void stir(double speed) { fluid_->set_equilibrium(3, 2, 1.0, {speed, 0.0}); }
  std::string file(const std::string& name) const { return read_file(folder_.path() + "/" + name); }

  test::TemporaryFolder folder_;
  Scene scene_;
  Plan plan_;
  std::optional<Fluid> fluid_;
  std::optional<Log> log_;
  std::optional<Observers> observers_;
};

TEST_F(ObserversTest, LookAtTheNextStateThatAnythingIsDueAt) {
  watch("[output]\nfields_every = 0.05\nprobe_every = 0.03\npoints = [[0.05, 0.05]]\n");
  EXPECT_EQ(observers_->next_look(0), 30);   // points
  EXPECT_EQ(observers_->next_look(30), 50);  // fields
  EXPECT_EQ(observers_->next_look(50), 60);
  EXPECT_TRUE(observers_->draws_at(50));
  EXPECT_FALSE(observers_->draws_at(30));
  watch("[output]\nprobe_every = 0.03\n[[obstacle]]\ncentre = [0.05, 0.04]\ndiameter = 0.04\n");
  EXPECT_EQ(observers_->next_look(7), 30);  // loads of obstacles are summed within the steps
}

TEST_F(ObserversTest, WarnOnceAboveATenthAndStopAboveAFifthOfC) {
  watch();
  stir(0.09);
  observers_->at_state(0, *fluid_, nullptr);
  stir(0.13);
  for (const std::int64_t state : {10, 20}) observers_->after_interval(state, *fluid_, nullptr);
  observers_->at_state(40, *fluid_, nullptr, true);
  const std::string log = file("lbm.log");
  const auto first = log.find("compressibility error; a run stops at 0.2");
  ASSERT_NE(first, std::string::npos) << log;
  EXPECT_EQ(log.find("compressibility error", first + 1), std::string::npos) << log;
  stir(0.21);
  try {
    observers_->at_state(50, *fluid_, nullptr, true);
    ADD_FAILURE() << "the run goes on";
  } catch (const NumericsError& error) {
    for (const char* words : {"interval 50", "(0.035, 0.025) m", "0.21 C, above 0.2"})
      EXPECT_NE(std::string(error.what()).find(words), std::string::npos) << error.what();
  }
}

TEST_F(ObserversTest, NameThePlaceOfWhatIsNotFinite) {
  watch();
  stir(std::numeric_limits<double>::quiet_NaN());
  try {
    observers_->at_state(0, *fluid_, nullptr);
    ADD_FAILURE() << "the run goes on";
  } catch (const NumericsError& error) {
    EXPECT_NE(
        std::string(error.what()).find("interval 0: the fluid is not finite at (0.035, 0.025)"),
        std::string::npos)
        << error.what();
  }
}

TEST_F(ObserversTest, SummaryHasTheLargestSpeedOfTheRun) {
  watch();
  stir(0.05);
  observers_->at_state(0, *fluid_, nullptr);
  stir(0.02);
  observers_->at_state(100, *fluid_, nullptr, true);
  const Summary summary = observers_->summary(1.0);
  EXPECT_NEAR(summary.ma_paper, 0.05, 1e-12);
  EXPECT_NEAR(summary.ma_max, 0.05 * std::sqrt(3.0), 1e-12);
}

TEST(PartClock, ChargesEverySecondToOnePart) {
  PartClock clock;
  std::this_thread::sleep_for(std::chrono::milliseconds(20));
  clock.charge("sweep");
  std::this_thread::sleep_for(std::chrono::milliseconds(5));
  clock.charge("loads");
  std::this_thread::sleep_for(std::chrono::milliseconds(20));
  clock.charge("sweep");
  ASSERT_EQ(clock.parts().size(), 2U);
  const double sweep = clock.parts().at("sweep"), loads = clock.parts().at("loads");
  EXPECT_GE(sweep, 0.04);
  EXPECT_GE(loads, 0.005);
  EXPECT_NEAR(clock.total(), sweep + loads, 1e-9);  // nothing is charged twice or to nobody
}

TEST(CsvWriter, ARunThatGoesOnKeepsTheLinesBeforeIt) {
  const test::TemporaryFolder folder;
  const std::string path = folder.path() + "/t.csv";
  {
    CsvWriter table(path, "time [s],x [m]");
    for (const double time : {0.0, 0.5, 1.0, 1.5}) table.row({time, 10.0 * time});
    table.flush();
  }
  CsvWriter table(path, "time [s],x [m]", 1.0);
  table.row({1.0, 11.0});
  table.flush();
  EXPECT_EQ(read_file(path), "time [s],x [m]\n0,0\n0.5,5\n1,11\n");
}

TEST(ProbeWriter, HasALineForEachParticleWithItsLoad) {
  const test::TemporaryFolder folder;
  ProbeWriter probes(folder.path(), 2, 0.0);
  std::vector<protocol::Particle> particles(2);
  std::vector<protocol::Load> loads(2);
  for (int i = 0; i < 2; ++i) {
    particles[i].state = {i + 5, {0.25, 0.5, 0.0}, {1.0, -1.0, 0.0}, {0.0, 0.0, 2.0}};
    loads[i] = {i + 5, {3.0, 4.0, 0.0}, {0.0, 0.0, 0.5 * i}};
  }
  probes.write(0.125, particles, loads);
  const std::string table = read_file(folder.path() + "/probes.csv");
  const std::string rows = table.substr(table.find('\n') + 1);
  EXPECT_EQ(rows, "0.125,5,0.25,0.5,1,-1,2,3,4,0\n0.125,6,0.25,0.5,1,-1,2,3,4,0.5\n") << table;
}

}  // namespace
