// SPDX-License-Identifier: MIT
#include "protocol/program.h"

#include <fmt/format.h>
#include <mpi.h>
#include <unistd.h>

#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <fstream>

#include "protocol/numbers.h"

namespace protocol {

namespace {

constexpr double kFarewellSeconds = 3.0;
volatile std::sig_atomic_t caught = 0;
std::timespec lives_at{};  // the partner, for sure: at the signal, or at an answer since
volatile std::sig_atomic_t code_at_deadline = 0;
std::string text_at_deadline;

void note_signal(int signal) {
  if (!caught) clock_gettime(CLOCK_MONOTONIC, &lives_at);
  caught = signal;
}

double seconds_since_life() {
  std::timespec now{};
  clock_gettime(CLOCK_MONOTONIC, &now);
  return static_cast<double>(now.tv_sec - lives_at.tv_sec) +
         1e-9 * static_cast<double>(now.tv_nsec - lives_at.tv_nsec);
}

double grace() {
  return seconds_from_environment("BPLBM_GRACE", 0.6);
}

}  // namespace

void catch_signals() {
  for (const int signal : {SIGTERM, SIGINT}) std::signal(signal, note_signal);
}

bool signalled() {
  return caught != 0;
}

void note_answer() {
  if (caught) clock_gettime(CLOCK_MONOTONIC, &lives_at);
}

void throw_if_signalled() {
  if (!caught || seconds_since_life() < grace()) return;
  throw ProtocolError(
      fmt::format("ended by signal {}: the partner or mpirun died, or somebody stopped the job",
                  static_cast<int>(caught)));
}

int exit_code_of(const std::exception& error) {
  const auto* known = dynamic_cast<const ProtocolError*>(&error);
  return known ? known->exit_code() : kFault;
}

int leave_after(const std::exception& error, const std::string& program, Channel* channel) {
  const int code = exit_code_of(error);
  const auto* from_peer = dynamic_cast<const PeerFault*>(&error);
  const bool in_order = dynamic_cast<const Refusal*>(&error) != nullptr ||
                        dynamic_cast<const PeerLeft*>(&error) != nullptr;
  if (!channel || channel->local_rank() == 0) {
    std::fflush(stdout);
    if (from_peer)
      fmt::print(stderr, "{} | error | the {} program stopped: {}\n", program,
                 channel ? channel->remote_name() : "other", error.what());
    else
      fmt::print(stderr, "{} | error | {}\n", program, error.what());
    std::fflush(stderr);
  }
  if (in_order) return code;
  if (caught) abort_job(code);  // mpirun is ending the job: nobody is left to talk to
  if (channel && from_peer) {
    channel->say_farewell();
    // the partner ends the job with its own exit code; be patient with it for a moment
    channel->await_farewell(kFarewellSeconds);
  } else if (channel) {
    channel->raise({code, error.what()});
    channel->await_farewell(kFarewellSeconds);
  }
  abort_job(code);
}

Deadline::Deadline(const std::exception& error, const std::string& program, unsigned seconds) {
  code_at_deadline = exit_code_of(error);
  text_at_deadline = fmt::format("{} | error | {}\n", program, error.what());
  std::signal(SIGALRM, [](int) {
    [[maybe_unused]] const auto written =
        write(STDERR_FILENO, text_at_deadline.data(), text_at_deadline.size());
    std::_Exit(code_at_deadline);
  });
  alarm(seconds);
}

Deadline::~Deadline() {
  alarm(0);
}

std::string last_error_line(const std::vector<std::string>& files) {
  std::string line, found;
  for (const std::string& file : files) {
    std::ifstream text(file);
    while (std::getline(text, line))
      if (line.starts_with("ERROR")) found = line;
  }
  return found;
}

void end_with_engine(const std::string& reason, Channel* channel, bool lonely) {
  if (channel && (lonely || channel->local_rank() == 0)) {
    channel->raise({kFault, reason});
    channel->await_farewell(kFarewellSeconds);
  } else if (channel) {
    sleep(static_cast<unsigned>(kFarewellSeconds) + 1);  // rank 0 ends the job
  }
  abort_job(kFault);
}

void abort_job(int exit_code) {
  std::fflush(stdout);
  std::fflush(stderr);
  int initialized = 0, finalized = 0;
  MPI_Initialized(&initialized);
  MPI_Finalized(&finalized);
  if (initialized && !finalized) PMPI_Abort(MPI_COMM_WORLD, exit_code);
  std::_Exit(exit_code);
}

}  // namespace protocol
