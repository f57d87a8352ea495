// SPDX-License-Identifier: MIT
#include "protocol/transport/memory_channel.h"

#include <chrono>
#include <condition_variable>
#include <deque>
#include <mutex>
#include <optional>
#include <utility>

#include "protocol/wire/text.h"

namespace protocol {

std::string timeout_text(const Channel& channel, int remote, const Wait& wait) {
  return format("no answer from {} rank {} for {:.3g} s while waiting for {}",
                channel.remote_name(), remote, wait.seconds, wait.what);
}

namespace {

/// What one rank has in its letter box: a queue a sender, and the urgent news.
struct Inbox {
  std::vector<std::deque<Bytes>> from;
  std::optional<Fault> fault;
  std::vector<bool> left;  // [sender] whether it said farewell
};

struct Exchange {
  std::mutex mutex;
  std::condition_variable changed;
  std::vector<Inbox> inbox[2];  // [side][rank]
};

class MemoryChannel final : public Channel {
 public:
  MemoryChannel(std::shared_ptr<Exchange> exchange, int side, int rank)
      : exchange_(std::move(exchange)), side_(side), rank_(rank) {}

  int local_rank() const override { return rank_; }
  int remote_size() const override { return static_cast<int>(theirs().size()); }
  std::string remote_name() const override { return side_ == 0 ? "solid" : "fluid"; }

  void send(int remote, Bytes frame, const Wait&) override {
    const std::scoped_lock lock(exchange_->mutex);
    throw_fault();
    theirs()[remote].from[rank_].push_back(std::move(frame));
    exchange_->changed.notify_all();
  }

  Bytes receive(int remote, const Wait& wait) override {
    std::unique_lock lock(exchange_->mutex);
    auto& queue = mine().from[remote];
    const bool came = exchange_->changed.wait_for(
        lock, std::chrono::duration<double>(wait.seconds),
        [&] { return mine().fault.has_value() || !queue.empty() || mine().left[remote]; });
    throw_fault();
    if (came && queue.empty())
      throw PeerLeft(format("{} rank {} left without {}", remote_name(), remote, wait.what));
    if (!came) throw Timeout(timeout_text(*this, remote, wait));
    Bytes frame = std::move(queue.front());
    queue.pop_front();
    return frame;
  }

  void raise(const Fault& fault) noexcept override {
    const std::scoped_lock lock(exchange_->mutex);
    for (auto& inbox : theirs()) inbox.fault = fault;
    exchange_->changed.notify_all();
  }
  Ending await_farewell(double seconds) noexcept override {
    std::unique_lock lock(exchange_->mutex);
    Ending ending;
    exchange_->changed.wait_for(lock, std::chrono::duration<double>(seconds), [&] {
      ending = {{}, mine().fault};
      for (int r = 0; r < remote_size(); ++r)
        if (!mine().left[r]) ending.missing.push_back(r);
      return ending.fault || ending.missing.empty();
    });
    return ending;
  }
  void say_farewell() noexcept override {
    const std::scoped_lock lock(exchange_->mutex);
    for (auto& inbox : theirs()) inbox.left[rank_] = true;
    exchange_->changed.notify_all();
  }

 private:
  Inbox& mine() const { return exchange_->inbox[side_][rank_]; }
  std::vector<Inbox>& theirs() const { return exchange_->inbox[1 - side_]; }
  void throw_fault() const {
    if (mine().fault) throw PeerFault(*mine().fault);
  }

  std::shared_ptr<Exchange> exchange_;
  int side_, rank_;
};

}  // namespace

MemoryLink make_memory_link(int fluid_ranks, int solid_ranks) {
  auto exchange = std::make_shared<Exchange>();
  const int ranks[2] = {fluid_ranks, solid_ranks};
  for (int side = 0; side < 2; ++side) {
    exchange->inbox[side].resize(ranks[side]);
    for (auto& inbox : exchange->inbox[side]) {
      inbox.from.resize(ranks[1 - side]);
      inbox.left.resize(ranks[1 - side]);
    }
  }
  MemoryLink link;
  for (int r = 0; r < fluid_ranks; ++r)
    link.fluid.push_back(std::make_unique<MemoryChannel>(exchange, 0, r));
  for (int r = 0; r < solid_ranks; ++r)
    link.solid.push_back(std::make_unique<MemoryChannel>(exchange, 1, r));
  return link;
}

}  // namespace protocol
