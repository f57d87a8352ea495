// SPDX-License-Identifier: MIT
#include "protocol/transport/mpi_channel.h"

#include <algorithm>
#include <chrono>
#include <limits>
#include <optional>
#include <vector>

#include "protocol/program/program.h"
#include "protocol/program/watch.h"
#include "protocol/transport/polling.h"
#include "protocol/wire/numbers.h"
#include "protocol/wire/text.h"

namespace protocol {
namespace {

constexpr int kFrameTag = 7001;
constexpr int kUrgentTag = 7002;
constexpr int kRoleTag = 7003;
constexpr int kLeaderTag = 7004;
constexpr int kPatienceTag = 7005;
constexpr auto kOnItsWay = std::chrono::seconds(1);

using Clock = std::chrono::steady_clock;

class MpiChannel final : public Channel {
 public:
  MpiChannel(const World& world, Role role) : remote_(world.remote), role_(role) {
    MPI_Comm_rank(world.local, &rank_);
    MPI_Comm_remote_size(remote_, &remote_size_);
    outgoing_.resize(remote_size_);
    left_.resize(remote_size_);
    failed_.resize(remote_size_);
  }

  int local_rank() const override { return rank_; }
  int remote_size() const override { return remote_size_; }
  std::string remote_name() const override { return role_ == Role::Fluid ? "solid" : "fluid"; }

  void send(int remote, Bytes frame, const Wait& wait) override {
    MPI_Request request;
    Bytes& kept = outgoing_[remote];  // outlives a send that a fault interrupts
    kept = std::move(frame);
    MPI_Isend(kept.data(), length(kept), MPI_BYTE, remote, kFrameTag, remote_, &request);
    int done = 0;
    const bool sent = poll(wait.seconds, [&] {
      MPI_Test(&request, &done, MPI_STATUS_IGNORE);
      if (!done) throw_if_stopped();
      return done != 0;
    });
    if (!sent) give_up(remote, wait);
  }

  Bytes receive(int remote, const Wait& wait) override {
    MPI_Status status;
    int here = 0;
    const bool came = poll(wait.seconds, [&] {
      MPI_Iprobe(remote, kFrameTag, remote_, &here, &status);
      if (!here) throw_if_stopped();
      if (!here) throw_if_left(remote, wait);
      return here != 0;
    });
    if (!came) give_up(remote, wait);
    note_answer();
    return take(status);
  }

  void raise(const Fault& fault) noexcept override {
    raised_ = true;
    post_urgent(encode(fault));
  }
  void say_farewell() noexcept override {
    post_urgent(encode(Farewell{}));
    poll(1.0, [this] {
      int done = 0;
      MPI_Testall(static_cast<int>(urgent_.size()), urgent_.data(), &done, MPI_STATUSES_IGNORE);
      return done != 0;
    });
  }
  Ending await_farewell(double seconds) noexcept override {
    Ending ending;
    poll(seconds, [&] {
      if (const Fault* fault = hear_urgent(); fault && !raised_) ending.fault = *fault;
      ending.missing.clear();
      for (int r = 0; r < remote_size_; ++r)
        if (!left_[r] && !(raised_ && failed_[r])) ending.missing.push_back(r);
      return ending.fault || ending.missing.empty();
    });
    return ending;
  }

 private:
  static int length(const Bytes& frame) {
    if (frame.size() > static_cast<std::size_t>(std::numeric_limits<int>::max()))
      throw ProtocolError(
          format("a message of {} bytes exceeds MPI's 2 GiB: use more ranks", frame.size()));
    return static_cast<int>(frame.size());
  }

  Bytes take(MPI_Status& status) {
    int size = 0;
    MPI_Get_count(&status, MPI_BYTE, &size);
    Bytes frame(size);
    MPI_Recv(frame.data(), size, MPI_BYTE, status.MPI_SOURCE, status.MPI_TAG, remote_,
             MPI_STATUS_IGNORE);
    return frame;
  }

  /// @throws PeerFault, or ProgramError where a signal has come
  void throw_if_stopped() {
    throw_if_signalled();
    if (const Fault* fault = hear_urgent()) throw PeerFault(*fault);
  }

  /// Takes an urgent frame if there is one. @return the fault that it is, or null
  const Fault* hear_urgent() {
    MPI_Status status;
    int here = 0;
    MPI_Iprobe(MPI_ANY_SOURCE, kUrgentTag, remote_, &here, &status);
    if (!here) return nullptr;
    const int source = status.MPI_SOURCE;
    const Bytes frame = take(status);
    if (kind_of(frame) == Kind::Fault) {
      failed_[source] = true;
      return &fault_.emplace(decode<Fault>(frame));
    }
    left_[source] = Clock::now();
    return nullptr;
  }

  /// After its farewell a rank sends nothing more; what it sent before may still be on its way.
  void throw_if_left(int remote, const Wait& wait) const {
    if (left_[remote] && Clock::now() - *left_[remote] > kOnItsWay)
      throw PeerLeft(format("{} rank {} left without {}", remote_name(), remote, wait.what));
  }

  [[noreturn]] void give_up(int remote, const Wait& wait) const {
    const std::string silent = silent_ranks(), text = timeout_text(*this, remote, wait);
    throw Timeout(silent.empty() ? text : format("{} ({})", silent, text));
  }

  /// The frames stay alive with the channel: the program is about to end, nobody waits for them.
  void post_urgent(const Bytes& frame) noexcept {
    urgent_frame_ = frame;
    urgent_.assign(remote_size_, MPI_REQUEST_NULL);
    for (int r = 0; r < remote_size_; ++r)
      MPI_Isend(urgent_frame_.data(), static_cast<int>(urgent_frame_.size()), MPI_BYTE, r,
                kUrgentTag, remote_, &urgent_[r]);
  }

  MPI_Comm remote_;
  Role role_;
  int rank_ = 0, remote_size_ = 0;
  std::vector<Bytes> outgoing_;
  Bytes urgent_frame_;
  std::vector<MPI_Request> urgent_;
  std::optional<Fault> fault_;                          ///< the last one of the other side
  bool raised_ = false;                                 ///< this side has failed
  std::vector<std::optional<Clock::time_point>> left_;  ///< [remote] when its farewell came
  std::vector<bool> failed_;                            ///< [remote] whether a fault of it came
};

constexpr const char* kEnvironment = "BPLBM_CONNECT_TIMEOUT";
constexpr double kFluidPatience = 30.0, kSolidPatience = 60.0;
double told_patience = 0.0;  // outlives the sends

/// A fluid says beside its role how long its scene wants the others to be waited for [s]. Who does
/// not know the message leaves it where it is.
void tell_patience(int ranks, double seconds) {
  told_patience = seconds;
  for (int r = 0; r < ranks; ++r) {
    MPI_Request request;
    MPI_Isend(&told_patience, 1, MPI_DOUBLE, r, kPatienceTag, MPI_COMM_WORLD, &request);
    MPI_Request_free(&request);
  }
}

/// @return the longest that a fluid has told since, or `seconds`
double hear_patience(double seconds) {
  for (;;) {
    MPI_Status status;
    int here = 0;
    MPI_Iprobe(MPI_ANY_SOURCE, kPatienceTag, MPI_COMM_WORLD, &here, &status);
    if (!here) return seconds;
    double heard = 0.0;
    MPI_Recv(&heard, 1, MPI_DOUBLE, status.MPI_SOURCE, kPatienceTag, MPI_COMM_WORLD,
             MPI_STATUS_IGNORE);
    seconds = std::max(seconds, heard);
  }
}

[[noreturn]] void name_silent(std::vector<MPI_Request>& receives, double seconds) {
  std::vector<std::size_t> silent;
  for (std::size_t r = 0; r < receives.size(); ++r) {
    int done = 0;
    MPI_Request_get_status(receives[r], &done, MPI_STATUS_IGNORE);
    if (!done) silent.push_back(r);
  }
  throw Timeout(
      format("rank(s) {} of this MPI job did not say within {:.3g} s that they are 'lbm' or an "
             "engine of it; the system's stock liggghts cannot couple: give the absolute path of "
             "build/release/bin/liggghts. An engine that needs longer to start is waited for with "
             "coupling.connect_timeout = SECONDS in the scene, or {} in the environment",
             join(silent, " "), seconds, kEnvironment));
}

/// Everybody tells everybody its role, without collectives.
std::vector<std::uint32_t> exchange_roles(Role role, double seconds) {
  constexpr double turn = 0.1;
  int me = 0, size = 0;
  MPI_Comm_rank(MPI_COMM_WORLD, &me);
  MPI_Comm_size(MPI_COMM_WORLD, &size);
  if (role == Role::Fluid) tell_patience(size, seconds);
  const std::uint32_t mine = static_cast<std::uint32_t>(role);
  std::vector<std::uint32_t> roles(size, 0);
  std::vector<MPI_Request> receives(size), sends(size);
  for (int r = 0; r < size; ++r) {
    MPI_Irecv(&roles[r], 1, MPI_UINT32_T, r, kRoleTag, MPI_COMM_WORLD, &receives[r]);
    MPI_Isend(&mine, 1, MPI_UINT32_T, r, kRoleTag, MPI_COMM_WORLD, &sends[r]);
  }
  const auto all = [&] {
    int received = 0, sent = 0;
    MPI_Testall(size, receives.data(), &received, MPI_STATUSES_IGNORE);
    MPI_Testall(size, sends.data(), &sent, MPI_STATUSES_IGNORE);
    return received && sent;
  };
  const auto begin = Clock::now();
  for (double left = seconds; !poll(std::min(left, turn), all);) {
    seconds = hear_patience(seconds);
    left = seconds - std::chrono::duration<double>(Clock::now() - begin).count();
    if (left <= 0.0) name_silent(receives, seconds);
  }
  return roles;
}

/// Every rank's place in its program, in the order of MPI_COMM_WORLD.
std::vector<Member> members(const std::vector<std::uint32_t>& roles) {
  std::vector<Member> all;
  for (std::size_t r = 0; r < roles.size(); ++r)
    all.push_back({static_cast<Role>(roles[r]),
                   static_cast<int>(std::count(roles.begin(), roles.begin() + r, roles[r]))});
  return all;
}

}  // namespace

World connect(Role role, double seconds) {
  if (seconds < 0.0) seconds = role == Role::Fluid ? kFluidPatience : kSolidPatience;
  seconds = seconds_from_environment(kEnvironment, seconds);
  const auto roles = exchange_roles(role, seconds);
  int me = 0;
  MPI_Comm_rank(MPI_COMM_WORLD, &me);
  start_watch(members(roles), me);
  limit_waits(seconds, Scope::Job);
  World world;
  MPI_Comm everybody;  // from here on all ranks are known to follow: collectives are safe
  MPI_Comm_dup(MPI_COMM_WORLD, &everybody);
  MPI_Comm_split(everybody, static_cast<int>(role), me, &world.local);
  const auto is_partner = [&](std::uint32_t r) { return r != static_cast<std::uint32_t>(role); };
  world.partner_ranks = static_cast<int>(std::count_if(roles.begin(), roles.end(), is_partner));
  if (world.coupled()) {
    const auto leader = std::find_if(roles.begin(), roles.end(), is_partner) - roles.begin();
    MPI_Intercomm_create(world.local, 0, everybody, static_cast<int>(leader), kLeaderTag,
                         &world.remote);
  }
  MPI_Comm_free(&everybody);
  limit_waits(std::numeric_limits<double>::infinity());
  return world;
}

void disconnect(World& world) {
  if (world.remote != MPI_COMM_NULL) MPI_Comm_free(&world.remote);
  if (world.local != MPI_COMM_NULL) MPI_Comm_free(&world.local);
}

std::unique_ptr<Channel> make_mpi_channel(const World& world, Role role) {
  return std::make_unique<MpiChannel>(world, role);
}

}  // namespace protocol
