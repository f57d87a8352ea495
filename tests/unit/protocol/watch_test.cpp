// SPDX-License-Identifier: MIT
/// The watch between processes that are no MPI job: a child plays one rank, the other is stopped.
#include "protocol/program/watch.h"

#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <functional>

namespace {

using namespace protocol;

const std::vector<Member> kJob{{Role::Fluid, 0}, {Role::Fluid, 1}, {Role::Solid, 0}};

/// A process that plays a rank of the job until it is killed.
class Rank {
 public:
  Rank(int rank, const std::function<void()>& life) : process_(fork()) {
    if (process_ != 0) return;
    alarm(30);
    start_watch(kJob, rank);
    life();
    _exit(0);
  }
  ~Rank() {
    kill(process_, SIGKILL);
    waitpid(process_, nullptr, 0);
  }
  Rank(const Rank&) = delete;
  Rank& operator=(const Rank&) = delete;
  void stop() const {
    kill(process_, SIGSTOP);
    usleep(100'000);  // until it is
  }

 private:
  pid_t process_;
};

void sleep_on() {
  for (;;) pause();
}
void keep_calling() {
  for (;;) {
    const Waiting here("MPI_Test");
    usleep(1000);
  }
}
void wait_on() {
  const Waiting here("MPI_Recv");
  sleep_on();
}

/// Runs `body` as fluid rank 0 in a process of its own, since the watch stays.
void as_fluid_rank_0(const std::function<void()>& body, int exit_code, const std::string& says) {
  EXPECT_EXIT(
      {
        alarm(30);
        start_watch(kJob, 0);
        usleep(300'000);  // until the others answer
        body();
        _exit(testing::Test::HasFailure() ? 99 : 0);
      },
      testing::ExitedWithCode(exit_code), says);
}

TEST(WatchDeathTest, TellsWhoWaitsWorksIsSilentOrAbsent) {
  setenv("PMIX_NAMESPACE", ("watch_test." + std::to_string(getpid())).c_str(), 1);
  const Rank one(1, wait_on);
  as_fluid_rank_0(
      [&] {
        EXPECT_EQ(signs_of(Role::Fluid).at(1).life, Life::Waits);
        EXPECT_EQ(signs_of(Role::Solid).at(0).life, Life::Absent);
        EXPECT_EQ(silent_ranks(), "");
        one.stop();
        EXPECT_EQ(signs_of(Role::Fluid).at(1).life, Life::Silent);
        EXPECT_EQ(silent_ranks(), "fluid rank 1 does not answer: its process is stopped or hangs");
      },
      0, "");
}

TEST(WatchDeathTest, SeesProgress) {
  setenv("PMIX_NAMESPACE", ("watch_test." + std::to_string(getpid())).c_str(), 1);
  const Rank solid(2, keep_calling);
  as_fluid_rank_0(
      [] {
        const LifeSign before = signs_of(Role::Solid).at(0);
        usleep(50'000);
        EXPECT_NE(signs_of(Role::Solid).at(0).turns, before.turns);
      },
      0, "");
}

TEST(WatchDeathTest, AWaitEndsWhereARankIsSilent) {
  setenv("PMIX_NAMESPACE", ("watch_test." + std::to_string(getpid())).c_str(), 1);
  const Rank one(1, wait_on);
  as_fluid_rank_0(
      [&] {
        one.stop();
        limit_waits(0.5, Scope::Program, 7);
        wait_on();
      },
      7, "error \\| fluid rank 1 does not answer.*fluid rank 0 has waited for .* s in MPI_Recv");
}

TEST(WatchDeathTest, AWaitEndsWhereARankDoesNothing) {
  setenv("PMIX_NAMESPACE", ("watch_test." + std::to_string(getpid())).c_str(), 1);
  const Rank one(1, sleep_on);
  as_fluid_rank_0(
      [] {
        limit_waits(1.0);
        wait_on();
      },
      1, "error \\| fluid rank 1 has not come so far");
}

TEST(WatchDeathTest, AWaitEndsWhereAllWait) {
  setenv("PMIX_NAMESPACE", ("watch_test." + std::to_string(getpid())).c_str(), 1);
  const Rank one(1, wait_on);
  as_fluid_rank_0(
      [] {
        limit_waits(0.5);
        wait_on();
      },
      1, "error \\| the ranks of this program wait for each other");
}

TEST(WatchDeathTest, AWaitGoesOnWhereAllMakeProgressAndOtherProgramsDoNotMatter) {
  setenv("PMIX_NAMESPACE", ("watch_test." + std::to_string(getpid())).c_str(), 1);
  const Rank one(1, keep_calling);
  as_fluid_rank_0(
      [] {
        limit_waits(0.5);  // solid rank 0 is absent
        const Waiting here("MPI_Recv");
        usleep(2'000'000);
      },
      0, "");
}

}  // namespace
