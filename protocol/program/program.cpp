// SPDX-License-Identifier: MIT
#include "protocol/program/program.h"

#include <mpi.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <fstream>

#include "protocol/program/watch.h"
#include "protocol/wire/numbers.h"
#include "protocol/wire/text.h"

namespace protocol {

namespace {

constexpr double kFarewellSeconds = 3.0;
constexpr double kEndSeconds = 2.0;     // a partner that has ended needs none of them
constexpr double kDefaultLimit = 60.0;  // of the end, where the program has set none
volatile std::sig_atomic_t caught = 0, signals = 0;
std::timespec lives_at{};  // the partner, for sure: at the signal, or at an answer since
volatile std::sig_atomic_t code_at_deadline = 0;
std::string text_at_deadline;

void note_signal(int signal) {
  if (!caught) clock_gettime(CLOCK_MONOTONIC, &lives_at);
  caught = signal;
  signals = signals + 1;
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
  throw ProgramError(
      format("ended by signal {}: the partner or mpirun died, or somebody stopped the job",
             static_cast<int>(caught)));
}

int exit_code_of(const std::exception& error) {
  const auto* known = dynamic_cast<const ProgramError*>(&error);
  return known ? known->exit_code() : kFault;
}

Parting part_after(const std::exception& error, const std::string& program, Channel* channel) {
  const int code = exit_code_of(error);
  const auto* from_peer = dynamic_cast<const PeerFault*>(&error);
  const bool in_order = dynamic_cast<const Refusal*>(&error) != nullptr ||
                        dynamic_cast<const PeerLeft*>(&error) != nullptr;
  if (!channel || channel->local_rank() == 0) {
    std::fflush(stdout);
    if (from_peer)
      print(stderr, "{} | error | the {} program stopped: {}\n", program,
            channel ? channel->remote_name() : "other", error.what());
    else
      print(stderr, "{} | error | {}\n", program, error.what());
    std::fflush(stderr);
  }
  // after a signal mpirun is ending the job: nobody is left to talk to
  if (in_order || caught) return {code, in_order};
  if (channel && from_peer) {
    channel->say_farewell();
    // the partner ends the job with its own exit code; be patient with it for a moment
    channel->await_farewell(kFarewellSeconds);
  } else if (channel) {
    channel->raise({code, error.what()});
    channel->await_farewell(kFarewellSeconds);
  }
  return {code, false};
}

int leave_after(const std::exception& error, const std::string& program, Channel* channel) {
  const Parting parting = part_after(error, program, channel);
  if (!parting.in_order) abort_job(parting.exit_code);
  return parting.exit_code;
}

namespace {

/// The end of one program of a job.
class End {
 public:
  End(int& exit_code, const std::string& program, Channel& channel)
      : exit_code_(exit_code), program_(program), channel_(channel) {}

  /// Until every rank of the partner has said farewell, or will never do so.
  void part() {
    channel_.say_farewell();
    Ending ending = wait(kEndSeconds);
    const Role partner = channel_.remote_name() == "fluid" ? Role::Fluid : Role::Solid;
    std::vector<LifeSign> before = signs_of(partner);
    if (before.empty()) return;  // there is no watch
    if (!ending.missing.empty())
      say(stdout, "end", format("waits for the farewell of {}", list_of(ending.missing)));
    while (!ending.missing.empty()) {
      std::erase_if(ending.missing, [&](int r) { return before.at(r).life == Life::Absent; });
      if (ending.missing.empty()) return;  // not ours to ask: it may wait in MPI's own end
      ending = wait(limit());
      const std::vector<LifeSign> now = signs_of(partner);
      const std::vector<int> lost = without_progress(ending.missing, before, now);
      if (!lost.empty()) {
        const std::string silent = silent_ranks();
        give_up(
            !silent.empty()
                ? silent
                : format("{} did not end within {:.3g} s, and did nothing; its program must say "
                         "farewell, by bplbm_close for one",
                         list_of(lost), limit()));
      }
      before = now;
    }
  }

  /// Nobody may stand still when MPI is finalised: that waits for all, and cannot be left.
  void expect_all() {
    const auto end = Clock::now() + std::chrono::duration<double>(limit());
    std::string silent;
    while (!(silent = silent_ranks()).empty())
      if (Clock::now() > end) give_up(silent);
  }

 private:
  using Clock = std::chrono::steady_clock;

  static double limit() { return std::isfinite(wait_limit()) ? wait_limit() : kDefaultLimit; }

  /// Of those that are missing. One that waits does so for another, unless nobody does anything.
  static std::vector<int> without_progress(const std::vector<int>& missing,
                                           const std::vector<LifeSign>& before,
                                           const std::vector<LifeSign>& now) {
    const auto moves = [&](int r) { return now.at(r).turns != before.at(r).turns; };
    std::vector<int> lost;
    for (const int r : missing)
      if (now[r].life == Life::Silent || (now[r].life == Life::Works && !moves(r)))
        lost.push_back(r);
    return lost.empty() && std::none_of(missing.begin(), missing.end(), moves) ? missing : lost;
  }

  Ending wait(double seconds) {
    const Ending ending = channel_.await_farewell(seconds);
    if (signals != signals_before_) abort_job(exit_code_ ? exit_code_ : kFault);
    if (!ending.fault) return ending;
    say(stderr, "error",
        format("the {} program stopped: {}", channel_.remote_name(), ending.fault->reason));
    channel_.await_farewell(kFarewellSeconds);  // the partner ends the job
    abort_job(exit_code_ ? exit_code_ : ending.fault->exit_code);
  }

  [[noreturn]] void give_up(const std::string& why) {
    if (!exit_code_) exit_code_ = kFault;
    say(stderr, "error", why);
    channel_.raise({exit_code_, why});
    channel_.await_farewell(1.0);
    abort_job(exit_code_);
  }

  void say(std::FILE* file, const char* part, const std::string& text) const {
    if (file == stdout && channel_.local_rank() != 0) return;
    std::fflush(stdout);
    print(file, "{} | {} | {}\n", program_, part, text);
    std::fflush(file);
  }

  std::string list_of(const std::vector<int>& ranks) const {
    return format("{} rank{} {}", channel_.remote_name(), ranks.size() > 1 ? "s" : "",
                  join(ranks, ", "));
  }

  int& exit_code_;
  const std::string& program_;
  Channel& channel_;
  const std::sig_atomic_t signals_before_ = signals;  // one may have led to this end
};

}  // namespace

int finish(int exit_code, const std::string& program, std::unique_ptr<Channel>& channel,
           MPI_Comm local) {
  if (local != MPI_COMM_NULL) MPI_Barrier(local);  // bounded as every wait inside a program
  if (channel) {
    End end(exit_code, program, *channel);
    end.part();
    end.expect_all();
  }
  channel.reset();  // a recording is complete, whatever follows
  std::fflush(stdout);
  for (const int signal : {SIGTERM, SIGINT}) std::signal(signal, SIG_DFL);
  const double limit = wait_limit();
  limit_waits(std::isfinite(limit) ? limit : kDefaultLimit, Scope::Job,
              exit_code ? exit_code : static_cast<int>(kFault));
  const Waiting here("MPI_Finalize");
  PMPI_Finalize();
  limit_waits(INFINITY);
  return exit_code;
}

Deadline::Deadline(const std::exception& error, const std::string& program, unsigned seconds) {
  code_at_deadline = exit_code_of(error);
  text_at_deadline = format("{} | error | {}\n", program, error.what());
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
