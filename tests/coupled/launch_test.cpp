// SPDX-License-Identifier: GPL-2.0-or-later
/// Programs that are started wrongly: each one that is there says what is missing, and ends.
#include <gtest/gtest.h>

#include "tests/support/coupled_job.h"

namespace {

using test::expect_end;
using test::JobResult;
using test::kLbm;
using test::kLiggghts;
using test::mpirun;
using test::SettlingDisc;

TEST(Launch, TheFluidAlone) {
  SettlingDisc scene;
  expect_end(test::run(kLbm, scene.folder(), 50.0), 2, {"no solid program was started beside lbm"});
}

TEST(Launch, TheSolidAlone) {
  SettlingDisc scene;
  const auto line = test::run(kLbm + " check --liggghts-vars", scene.folder(), 50.0);
  std::string variables = line.output;
  variables.erase(variables.find_last_not_of('\n') + 1);
  const std::string as_root = "export OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1; ";
  expect_end(test::run(as_root + kLiggghts + " -in in.liggghts " + variables, scene.folder(), 50.0),
             1, {"no fluid program was started beside liggghts"});
}

TEST(Launch, TheFluidTwice) {
  SettlingDisc scene;
  expect_end(test::run(mpirun({kLbm}, {kLbm}), scene.folder(), 50.0), 2,
             {"no solid program was started beside lbm"});
}

// MPI_Init waits for every program of the job, also for those that never come.
TEST(Launch, AProgramThatEndsBeforeItsMpiInit) {
  SettlingDisc scene;
  const std::string hurry = "export BPLBM_CONNECT_TIMEOUT=3; ";
  expect_end(test::run(hurry + mpirun({kLbm}, {"sleep 90"}), scene.folder(), 50.0), 1,
             {"lbm | error | MPI has not begun within 3 s: another program of this mpirun"});
  expect_end(test::run(hurry + mpirun({"sleep 90"}, {kLiggghts + " -in in.liggghts"}),
                       scene.folder(), 50.0),
             1, {"liggghts | error | MPI has not begun within 3 s"});
}

TEST(Launch, TheSolidTwice) {
  SettlingDisc scene;
  const auto line = test::run(kLbm + " check --liggghts-vars", scene.folder(), 50.0);
  std::string variables = line.output;
  variables.erase(variables.find_last_not_of('\n') + 1);
  const std::string solid = kLiggghts + " -in in.liggghts " + variables;
  expect_end(test::run(mpirun({solid}, {solid}), scene.folder(), 50.0), 1,
             {"no fluid program was started beside liggghts"});
}

TEST(Launch, TheSystemsStockLiggghts) {
  SettlingDisc scene;
  scene.change_scene("timeout = 60.0", "timeout = 60.0\nconnect_timeout = 3.0");
  expect_end(test::run(mpirun({kLbm}, {"/usr/bin/liggghts -in in.liggghts"}), scene.folder(), 50.0),
             1,
             {"lbm | error | rank(s) 1 of this MPI job did not say within 3 s",
              "the system's stock liggghts cannot couple", "coupling.connect_timeout = SECONDS"});
}

TEST(Launch, AStranger) {
  SettlingDisc scene;
  const test::TemporaryFolder folder;
  folder.write("stranger.c",
               "#include <mpi.h>\n#include <unistd.h>\nint main(int c, char** v) { MPI_Init(&c, "
               "&v); sleep(100); }\n");
  ASSERT_EQ(test::run("mpicc stranger.c -o stranger", folder.path(), 60.0).exit_code, 0);
  expect_end(test::run("export BPLBM_CONNECT_TIMEOUT=3; " +
                           mpirun({folder.path() + "/stranger"}, {kLiggghts + " -screen none"}),
                       scene.folder(), 50.0),
             1, {"liggghts | error | rank(s) 0 of this MPI job did not say"});
}

// Two solid ranks that start one after the other: whoever is there waits for the slower one.
TEST(Launch, ASlowEngineIsWaitedForAsLongAsTheSceneSays) {
  SettlingDisc scene;
  const std::string slow = test::kBin + "/leaving_solid slow 3";  // ranks 1 and 2 of the job
  scene.change_scene("timeout = 60.0", "timeout = 60.0\nconnect_timeout = 2.0");
  expect_end(test::run(mpirun({kLbm}, {slow, 2}), scene.folder(), 50.0), 1,
             {"lbm | error | rank(s) 1 2 of this MPI job did not say within 2 s",
              "coupling.connect_timeout = SECONDS in the scene"});
  scene.change_scene("connect_timeout = 2.0", "connect_timeout = 20.0");
  const auto job = test::run(mpirun({kLbm}, {slow, 2}), scene.folder(), 50.0);
  EXPECT_EQ(job.exit_code, 0) << job.output;
}

}  // namespace
