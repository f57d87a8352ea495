// SPDX-License-Identifier: MIT
#include "protocol/program/watch.h"

#include <errno.h>
#include <poll.h>
#include <pthread.h>
#include <signal.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <functional>
#include <limits>
#include <thread>
#include <utility>

#include "protocol/wire/text.h"

namespace protocol {
namespace {

using Clock = std::chrono::steady_clock;

constexpr int kAttempts = 4;               // a question may find a machine that is overloaded …
constexpr int kAttemptMilliseconds = 500;  // … so silence means two seconds of it
constexpr int kLookMilliseconds = 250;
constexpr double kStoodStill = 3.0;  // to ask, and to sleep until the next look, takes less
constexpr double kForever = std::numeric_limits<double>::infinity();

/// The answer to a question; a question is a datagram of any content.
struct Reply {
  std::int32_t rank = -1;  ///< in MPI_COMM_WORLD
  std::int32_t waits = 0;
  std::uint64_t turns = 0;
};

struct Job {
  std::vector<Member> members;
  int me = 0;
  std::size_t key = 0;  ///< what tells this job from others on the machine
};
Job* job = nullptr;  // never freed: the threads of the watch live as long as the process

std::atomic<double> limit{kForever};
std::atomic<Scope> limit_scope{Scope::Program};
std::atomic<int> limit_exit_code{1};

/// The launcher's names of the job and of its daemon here: the same for all of its processes.
std::size_t job_key() {
  std::string text = std::to_string(getuid());
  for (const char* name : {"PMIX_NAMESPACE", "PMIX_SERVER_URI2", "PMI_JOBID", "SLURM_JOB_ID"})
    if (const char* value = std::getenv(name)) text += std::string(" ") + value;
  return std::hash<std::string>{}(text);
}

/// Sockets in Linux' abstract name space: nothing lies in any folder, and they end with the
/// process.
socklen_t address_of(int rank, sockaddr_un& address) {
  address = {};
  address.sun_family = AF_UNIX;
  const std::string name = format("bplbm.{:x}.{}", job->key, rank);
  std::copy(name.begin(), name.end(), address.sun_path + 1);
  return static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + 1 + name.size());
}

int open_socket() {
  return socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0);
}

void answer_questions() {
  const int file = open_socket();
  sockaddr_un mine;
  const socklen_t length = address_of(job->me, mine);
  if (file < 0 || bind(file, reinterpret_cast<const sockaddr*>(&mine), length) != 0) return;
  for (;;) {
    char question;
    sockaddr_un asker;
    socklen_t size = sizeof asker;
    if (recvfrom(file, &question, 1, 0, reinterpret_cast<sockaddr*>(&asker), &size) < 0) {
      if (errno == EINTR) continue;
      return;
    }
    const Reply reply{job->me, pulse.waits_in.load(std::memory_order_relaxed) != nullptr,
                      pulse.turns.load(std::memory_order_relaxed)};
    sendto(file, &reply, sizeof reply, MSG_DONTWAIT | MSG_NOSIGNAL,
           reinterpret_cast<const sockaddr*>(&asker), size);
  }
}

bool in(Scope scope, std::size_t rank) {
  return static_cast<int>(rank) != job->me &&
         (scope == Scope::Job || job->members[rank].role == job->members[job->me].role);
}

/// Asks those who have not answered. @return whether there are any
bool ask(int file, Scope scope, std::vector<LifeSign>& answers) {
  bool any = false;
  for (std::size_t r = 0; r < answers.size(); ++r) {
    if (!in(scope, r) || answers[r].life == Life::Waits || answers[r].life == Life::Works) continue;
    sockaddr_un address;
    const socklen_t length = address_of(static_cast<int>(r), address);
    const bool there = sendto(file, "?", 1, MSG_DONTWAIT | MSG_NOSIGNAL,
                              reinterpret_cast<const sockaddr*>(&address), length) == 1 ||
                       errno == EAGAIN || errno == ENOBUFS;
    answers[r].life = there ? Life::Silent : Life::Absent;
    any = any || there;
  }
  return any;
}

/// Takes the answers that come within a while, until all have answered.
void listen(int file, std::vector<LifeSign>& answers) {
  const auto end = Clock::now() + std::chrono::milliseconds(kAttemptMilliseconds);
  const auto silent = [](const LifeSign& a) { return a.life == Life::Silent; };
  while (std::any_of(answers.begin(), answers.end(), silent)) {
    const auto left =
        std::chrono::duration_cast<std::chrono::milliseconds>(end - Clock::now()).count();
    pollfd ready{file, POLLIN, 0};
    if (left <= 0 || poll(&ready, 1, static_cast<int>(left)) == 0) return;
    Reply reply;
    if (recv(file, &reply, sizeof reply, MSG_DONTWAIT) != sizeof reply || reply.rank < 0 ||
        reply.rank >= static_cast<int>(answers.size()))
      continue;
    answers[reply.rank] = {reply.waits ? Life::Waits : Life::Works, reply.turns};
  }
}

/// @return  one answer a rank of the job
std::vector<LifeSign> call_roll(Scope scope) {
  std::vector<LifeSign> answers(job->members.size());
  const int file = open_socket();
  sockaddr_un own{};
  own.sun_family = AF_UNIX;  // without a name: the system gives one
  if (file >= 0 && bind(file, reinterpret_cast<const sockaddr*>(&own), sizeof(sa_family_t)) == 0)
    for (int attempt = 0; attempt < kAttempts && ask(file, scope, answers); ++attempt)
      listen(file, answers);
  if (file >= 0) close(file);
  return answers;
}

/// "fluid rank 1", "solid ranks 0, 2", "fluid rank 0 and solid rank 1"
std::string names(const std::vector<std::size_t>& ranks) {
  std::string text;
  for (const Role role : {Role::Fluid, Role::Solid}) {
    std::vector<int> own;
    for (const std::size_t r : ranks)
      if (job->members[r].role == role) own.push_back(job->members[r].rank);
    if (own.empty()) continue;
    text +=
        format("{}{} rank{} {}", text.empty() ? "" : " and ",
               role == Role::Fluid ? "fluid" : "solid", own.size() > 1 ? "s" : "", join(own, ", "));
  }
  return text;
}

template <class Condition>
std::vector<std::size_t> ranks_where(Scope scope, Condition&& condition) {
  std::vector<std::size_t> ranks;
  for (std::size_t r = 0; r < job->members.size(); ++r)
    if (in(scope, r) && condition(r)) ranks.push_back(r);
  return ranks;
}

std::string silence_of(const std::vector<std::size_t>& ranks) {
  if (ranks.empty()) return "";
  return ranks.size() == 1 ? names(ranks) + " does not answer: its process is stopped or hangs"
                           : names(ranks) + " do not answer: their processes are stopped or hang";
}

std::vector<std::size_t> silent_in(Scope scope, const std::vector<LifeSign>& answers) {
  return ranks_where(scope, [&](std::size_t r) { return answers[r].life == Life::Silent; });
}

/// Looks after the waits of the main thread.
class Lookout {
 public:
  [[noreturn]] void run() {
    for (;;) {
      std::this_thread::sleep_for(std::chrono::milliseconds(kLookMilliseconds));
      look();
    }
  }

 private:
  void look() {
    const char* call = pulse.waits_in.load(std::memory_order_relaxed);
    const std::uint64_t turns = pulse.turns.load(std::memory_order_relaxed);
    if (!call || turns != turns_ || stood_still()) return begin_anew();
    const double most = limit.load(), since = seconds(Clock::now() - asked_);
    const Scope scope = limit_scope.load();
    if (earlier_.empty() && since > 0.5 * most) {
      earlier_ = call_roll(scope);
      if (stood_still()) return begin_anew();
    }
    if (since <= most) return;
    const std::vector<LifeSign> answers = call_roll(scope);
    if (pulse.turns.load(std::memory_order_relaxed) != turns_ || stood_still()) return begin_anew();
    const std::string who = lost(scope, answers);
    if (!who.empty()) end(who, call, answers);
    earlier_ = answers;
    asked_ = Clock::now();
  }

  void begin_anew() {
    turns_ = pulse.turns.load(std::memory_order_relaxed);
    began_ = asked_ = looked_ = Clock::now();
    earlier_.clear();
  }

  /// Whether this process was stopped itself since the last call, or its machine slept.
  bool stood_still() {
    const auto before = std::exchange(looked_, Clock::now());
    return seconds(looked_ - before) > kStoodStill;
  }

  static double seconds(Clock::duration d) { return std::chrono::duration<double>(d).count(); }

  /// Why the wait will not end; empty where it may.
  std::string lost(Scope scope, const std::vector<LifeSign>& answers) const {
    const std::string silent = silence_of(silent_in(scope, answers));
    if (!silent.empty()) return silent;
    const auto stuck = ranks_where(scope, [&](std::size_t r) {
      return answers[r].life == Life::Works && answers[r].turns == earlier_[r].turns;
    });
    if (!stuck.empty()) return names(stuck) + " has not come so far";
    const auto absent =
        ranks_where(scope, [&](std::size_t r) { return answers[r].life == Life::Absent; });
    if (!absent.empty()) return "no sign of " + names(absent);
    const auto moved =
        ranks_where(scope, [&](std::size_t r) { return answers[r].turns != earlier_[r].turns; });
    return moved.empty() && scope == Scope::Program
               ? "the ranks of this program wait for each other"
               : "";
  }

  /// The lowest rank that lives says it for all of its program.
  [[noreturn]] void end(const std::string& who, const char* call,
                        const std::vector<LifeSign>& answers) const {
    for (int r = 0; r < job->me; ++r)
      if (answers[r].life == Life::Waits && in(Scope::Program, r)) {
        std::this_thread::sleep_for(std::chrono::seconds(1));
        break;
      }
    const Member& me = job->members[job->me];
    const std::string text =
        format("{} | error | {} ({} rank {} has waited for {:.3g} s in {})\n",
               program_invocation_short_name, who, me.role == Role::Fluid ? "fluid" : "solid",
               me.rank, seconds(Clock::now() - began_), call);
    if (ftrylockfile(stdout) == 0) {
      std::fflush(stdout);
      funlockfile(stdout);
    }
    [[maybe_unused]] const auto written = write(STDERR_FILENO, text.data(), text.size());
    std::_Exit(limit_exit_code.load());
  }

  std::uint64_t turns_ = 0;
  Clock::time_point began_ = Clock::now(), asked_ = began_, looked_ = began_;
  std::vector<LifeSign> earlier_;  // half of the limit ago
};

}  // namespace

void start_watch(std::vector<Member> members, int me) {
  const char* set = std::getenv("BPLBM_WATCH");
  if (job || members.size() < 2 || (set && std::string(set) == "0")) return;
  job = new Job{std::move(members), me, job_key()};
  sigset_t all, before;  // signals are for the main thread
  sigfillset(&all);
  pthread_sigmask(SIG_SETMASK, &all, &before);
  std::thread(answer_questions).detach();
  std::thread([] { Lookout().run(); }).detach();
  pthread_sigmask(SIG_SETMASK, &before, nullptr);
}

void limit_waits(double seconds, Scope scope, int exit_code) {
  limit_scope = scope;
  limit_exit_code = exit_code;
  limit = seconds;
}

double wait_limit() {
  return limit;
}

std::vector<LifeSign> signs_of(Role role) {
  std::vector<LifeSign> own;
  if (!job) return own;
  const std::vector<LifeSign> all = call_roll(Scope::Job);
  for (std::size_t r = 0; r < all.size(); ++r)
    if (job->members[r].role == role) own.push_back(all[r]);
  return own;
}

std::string silent_ranks() {
  return job ? silence_of(silent_in(Scope::Job, call_roll(Scope::Job))) : "";
}

}  // namespace protocol
