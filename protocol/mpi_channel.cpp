// SPDX-License-Identifier: MIT
#include "protocol/mpi_channel.h"

#include <fmt/format.h>
#include <sched.h>

#include <algorithm>
#include <chrono>
#include <limits>
#include <vector>

#include "protocol/numbers.h"
#include "protocol/program.h"

namespace protocol {
namespace {

constexpr int kFrameTag = 7001;
constexpr int kUrgentTag = 7002;
constexpr int kRoleTag = 7003;
constexpr int kLeaderTag = 7004;

using Clock = std::chrono::steady_clock;

/// Polls until `ready` or until the time is over. A short busy wait keeps the latency of a ready
/// partner; afterwards the core is offered to others at every turn, because the partner may need
/// it.
template <class Ready>
bool poll(double seconds, Ready&& ready) {
  constexpr int busy_turns = 2000;
  for (int turn = 0; turn < busy_turns; ++turn)
    if (ready()) return true;
  const auto end = Clock::now() + std::chrono::duration<double>(seconds);
  while (Clock::now() < end) {
    if (ready()) return true;
    sched_yield();
  }
  return ready();
}

class MpiChannel final : public Channel {
 public:
  MpiChannel(const World& world, Role role) : remote_(world.remote), role_(role) {
    MPI_Comm_rank(world.local, &rank_);
    MPI_Comm_remote_size(remote_, &remote_size_);
    outgoing_.resize(remote_size_);
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
    if (!sent) throw Timeout(timeout_text(*this, remote, wait));
  }

  Bytes receive(int remote, const Wait& wait) override {
    MPI_Status status;
    int here = 0;
    const bool came = poll(wait.seconds, [&] {
      MPI_Iprobe(remote, kFrameTag, remote_, &here, &status);
      if (!here) throw_if_stopped();
      return here != 0;
    });
    if (!came) throw Timeout(timeout_text(*this, remote, wait));
    note_answer();
    return take(status);
  }

  void raise(const Fault& fault) noexcept override { post_urgent(encode(fault)); }
  void say_farewell() noexcept override {
    post_urgent(encode(Farewell{}));
    poll(1.0, [this] {
      int done = 0;
      MPI_Testall(static_cast<int>(urgent_.size()), urgent_.data(), &done, MPI_STATUSES_IGNORE);
      return done != 0;
    });
  }
  void await_farewell(double seconds) noexcept override {
    int farewells = 0;  // a fault raised by the other side at the same time counts as one
    poll(seconds, [&] {
      MPI_Status status;
      int here = 0;
      MPI_Iprobe(MPI_ANY_SOURCE, kUrgentTag, remote_, &here, &status);
      if (here) {
        take(status);
        ++farewells;
      }
      return farewells >= remote_size_;
    });
  }

 private:
  static int length(const Bytes& frame) {
    if (frame.size() > static_cast<std::size_t>(std::numeric_limits<int>::max()))
      throw ProtocolError(
          fmt::format("a message of {} bytes exceeds MPI's 2 GiB: use more ranks", frame.size()));
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

  void throw_if_stopped() {
    throw_if_signalled();
    MPI_Status status;
    int here = 0;
    MPI_Iprobe(MPI_ANY_SOURCE, kUrgentTag, remote_, &here, &status);
    if (!here) return;
    const Bytes frame = take(status);
    if (kind_of(frame) == Kind::Fault) throw PeerFault(decode<Fault>(frame));
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
};

double patience(double seconds) {
  if (seconds >= 0.0) return seconds;
  return seconds_from_environment("BPLBM_CONNECT_TIMEOUT", 5.0);
}

/// Everybody tells everybody its role, without collectives.
std::vector<std::uint32_t> exchange_roles(Role role, double seconds) {
  int me = 0, size = 0;
  MPI_Comm_rank(MPI_COMM_WORLD, &me);
  MPI_Comm_size(MPI_COMM_WORLD, &size);
  const std::uint32_t mine = static_cast<std::uint32_t>(role);
  std::vector<std::uint32_t> roles(size, 0);
  std::vector<MPI_Request> receives(size), sends(size);
  for (int r = 0; r < size; ++r) {
    MPI_Irecv(&roles[r], 1, MPI_UINT32_T, r, kRoleTag, MPI_COMM_WORLD, &receives[r]);
    MPI_Isend(&mine, 1, MPI_UINT32_T, r, kRoleTag, MPI_COMM_WORLD, &sends[r]);
  }
  const bool all = poll(seconds, [&] {
    int received = 0, sent = 0;
    MPI_Testall(size, receives.data(), &received, MPI_STATUSES_IGNORE);
    MPI_Testall(size, sends.data(), &sent, MPI_STATUSES_IGNORE);
    return received && sent;
  });
  if (!all) {
    std::string silent;
    for (int r = 0; r < size; ++r) {
      int done = 0;
      MPI_Request_get_status(receives[r], &done, MPI_STATUS_IGNORE);
      if (!done) silent += fmt::format(" {}", r);
    }
    throw Timeout(
        fmt::format("rank(s){} of this MPI job did not say within {:.3g} s that they are 'lbm' or "
                    "our 'liggghts'; the system's stock liggghts cannot couple: give the absolute "
                    "path of build/release/bin/liggghts",
                    silent, seconds));
  }
  return roles;
}

}  // namespace

World connect(Role role, double seconds) {
  const auto roles = exchange_roles(role, patience(seconds));
  int me = 0;
  MPI_Comm_rank(MPI_COMM_WORLD, &me);
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
  return world;
}

void disconnect(World& world) {
  if (world.remote != MPI_COMM_NULL) MPI_Comm_disconnect(&world.remote);
  if (world.local != MPI_COMM_NULL) MPI_Comm_free(&world.local);
}

std::unique_ptr<Channel> make_mpi_channel(const World& world, Role role) {
  return std::make_unique<MpiChannel>(world, role);
}

}  // namespace protocol
