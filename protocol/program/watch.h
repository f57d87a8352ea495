// SPDX-License-Identifier: MIT
/// What the main thread of this process waits for, and who of the job still answers. Costs nothing
/// while all goes well: others are asked only when a wait has become too long.
#pragma once

#include <atomic>
#include <cstdint>
#include <string>
#include <vector>

#include "protocol/wire/messages.h"

namespace protocol {

/// A rank of the job, by its place in its own program.
struct Member {
  Role role = Role::Fluid;
  int rank = 0;
};

/// Whose answers decide whether a wait that has become too long goes on.
enum class Scope { Program, Job };

/// Traces of life of the main thread, for the threads of the watch.
struct Pulse {
  std::atomic<const char*> waits_in{nullptr};  ///< name of the call; null while it works
  std::atomic<std::uint64_t> turns{0};         ///< calls so far
};
inline Pulse pulse;

/// The main thread is in a call that may have to wait for other ranks while this object lives.
class Waiting {
 public:
  explicit Waiting(const char* call) noexcept
      : before_(pulse.waits_in.load(std::memory_order_relaxed)) {
    pulse.turns.store(pulse.turns.load(std::memory_order_relaxed) + 1, std::memory_order_relaxed);
    pulse.waits_in.store(call, std::memory_order_relaxed);
  }
  ~Waiting() { pulse.waits_in.store(before_, std::memory_order_relaxed); }
  Waiting(const Waiting&) = delete;
  Waiting& operator=(const Waiting&) = delete;

 private:
  const char* before_;
};

/// Begins to answer the other ranks of the job on this machine, and to look after the waits of the
/// main thread. Once a process; later calls do nothing, as does BPLBM_WATCH=0 in the environment.
/// @param job  every rank of MPI_COMM_WORLD, by rank
/// @param me   this one
void start_watch(std::vector<Member> job, int me);

/// From now on a `Waiting` that lasts longer ends the process with a message, unless every rank of
/// the scope answers, and waits itself or has made MPI calls meanwhile.
/// @param seconds    infinite: no limit, as at the start
/// @param exit_code  with which the process ends then
void limit_waits(double seconds, Scope scope = Scope::Program, int exit_code = 1);

/// The limit in force [s].
double wait_limit();

/// How a rank answers: not at all since it cannot be asked (another machine, a program without a
/// watch), or though it is there; in a call that may have to wait for others; or outside of any.
enum class Life { Absent, Silent, Waits, Works };
struct LifeSign {
  Life life = Life::Absent;
  std::uint64_t turns = 0;  ///< MPI calls so far
};
/// Asks the ranks of a program, of which this is none. Takes two seconds where one is silent.
std::vector<LifeSign> signs_of(Role role);

/// Asks every rank of the job. @return e.g. "fluid rank 1 does not answer: its process is stopped
/// or hangs"; empty where all that can be asked answer. Takes two seconds where one is silent.
std::string silent_ranks();

}  // namespace protocol
