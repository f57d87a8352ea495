// SPDX-License-Identifier: MIT
#include "protocol/program/mpi_start.h"

#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <utility>

#include "protocol/wire/messages.h"
#include "protocol/wire/numbers.h"
#include "protocol/wire/text.h"

namespace protocol {
namespace {

/// A mistake in the environment is said when the programs look for each other.
double limit_of(double seconds) try {
  return seconds_from_environment("BPLBM_CONNECT_TIMEOUT", std::max(60.0, 2.0 * seconds));
} catch (const ProgramError&) {
  return std::max(60.0, 2.0 * seconds);
}

}  // namespace

MpiStart::MpiStart(std::string program, double seconds)
    : program_(std::move(program)), limit_(limit_of(seconds)), thread_([this] { watch(); }) {}

MpiStart::~MpiStart() {
  {
    const std::lock_guard lock(mutex_);
    begun_ = true;
  }
  begun_condition_.notify_one();
  thread_.join();
}

void MpiStart::watch() {
  std::unique_lock lock(mutex_);
  if (begun_condition_.wait_for(lock, std::chrono::duration<double>(limit_),
                                [this] { return begun_; }))
    return;
  std::fflush(stdout);
  print(stderr,
        "{} | error | MPI has not begun within {:.3g} s: another program of this mpirun has ended "
        "before its MPI_Init, or hangs there; look whether each command behind a ':' is the right "
        "one, and of the same MPI. One that needs longer to start is waited for with "
        "coupling.connect_timeout = SECONDS in the scene, or BPLBM_CONNECT_TIMEOUT in the "
        "environment\n",
        program_, limit_);
  std::fflush(stderr);
  _exit(kFault);
}

}  // namespace protocol
