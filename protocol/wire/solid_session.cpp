// SPDX-License-Identifier: MIT
#include "protocol/wire/session.h"

#include <algorithm>
#include <cstring>
#include <utility>

#include "protocol/wire/names.h"
#include "protocol/wire/numbers.h"
#include "protocol/wire/routing.h"
#include "protocol/wire/session_parts.h"
#include "protocol/wire/text.h"

namespace protocol {
namespace {

[[noreturn]] void refuse_astray(const State& s, std::int64_t interval) {
  throw ProtocolError(
      format("{}: its centre ({:.6g}, {:.6g}, {:.6g}) m lies far outside of the box at interval "
             "{}; correct its place, or delete it",
             name_of(s.id), s.x[0], s.x[1], s.x[2], interval),
      kBadInput);
}

/// What a fluid's scene says of the longest wait.
double timeout_of(const Hello& fluid, double fallback) {
  for (const Variable& v : fluid.variables)
    if (v.name == "coupling_timeout") {
      const auto seconds = to_number<double>(v.value);
      if (seconds && *seconds > 0.0) return *seconds;
    }
  return fallback;
}

}  // namespace

SolidSession::SolidSession(Channel& channel, double timeout)
    : channel_(&channel),
      timeout_(timeout),
      told_(channel.remote_size()),
      sent_(channel.remote_size()) {
  const Stopwatch watch(waited_);
  for (int r = 0; r < channel_->remote_size(); ++r) {
    fluid_.push_back(decode<Hello>(channel_->receive(r, {timeout_, "its handshake"})));
    timeout_ = timeout_of(fluid_.back(), timeout_);
  }
}

void SolidSession::agree(const Hello& hello) {
  const Stopwatch watch(waited_);
  for (int r = 0; r < channel_->remote_size(); ++r)
    channel_->send(r, encode(hello), {timeout_, "it to take our handshake"});
  setting_ = {hello.step, hello.box_lo, hello.box_hi};
  settle(*channel_, fluid_.front(), hello, {timeout_, "its answer to our handshake"});
}

void SolidSession::send(const StepHeader& head, std::span<const State> states,
                        std::span<const Shape> shapes, const std::optional<SolidReport>& report) {
  const Stopwatch watch(waited_);
  for (int r = 0; r < channel_->remote_size(); ++r)
    send_states(r, head, states, shapes, r == 0 ? report : std::nullopt);
  head_ = head;
  loads_.assign(states.size(), Load{});
  for (std::size_t i = 0; i < states.size(); ++i) loads_[i].id = states[i].id;
}

SolidSession::Reply SolidSession::collect() {
  const Stopwatch watch(waited_);
  Reply reply;
  for (int r = 0; r < channel_->remote_size(); ++r) reply.flags |= add_loads(r);
  reply.loads = loads_;
  return reply;
}

SolidSession::Reply SolidSession::exchange(const StepHeader& head, std::span<const State> states,
                                           std::span<const Shape> shapes,
                                           const std::optional<SolidReport>& report) {
  send(head, states, shapes, report);
  if (head.flags & kLast) return {kContinue, loads_};
  return collect();
}

void SolidSession::send_states(int rank, const StepHeader& head, std::span<const State> states,
                               std::span<const Shape> shapes,
                               const std::optional<SolidReport>& report) {
  StateBatch batch{head, setting_, {}, {}, report};
  batch.states.reserve(states.size());
  std::vector<Shape>& told = told_[rank];
  std::unordered_map<std::int64_t, Shape> others;  // told before; only where the order has changed
  bool in_order = true;
  const bool clumps = std::ranges::any_of(shapes, is_part);
  const std::vector<std::size_t> by = clumps ? routed_by(shapes) : std::vector<std::size_t>();
  sent_[rank].clear();
  for (std::size_t i = 0; i < states.size(); ++i) {
    const State& state = states[i];
    const std::size_t whole = clumps ? by[i] : i;
    if (!touches(fluid_[rank], states[whole].x, shapes[whole].radius)) {
      if (astray(fluid_[rank], state.x)) refuse_astray(state, head.interval);
      continue;
    }
    const std::size_t place = batch.states.size();
    if (in_order && (place >= told.size() || told[place].id != state.id)) {
      in_order = false;
      for (std::size_t n = place; n < told.size(); ++n) others.emplace(told[n].id, told[n]);
      told.resize(place);
    }
    if (!in_order) {
      const auto known = others.find(state.id);
      told.push_back(known == others.end() ? Shape{} : known->second);
    }
    if (std::memcmp(&told[place], &shapes[i], sizeof(Shape)) != 0) {
      told[place] = shapes[i];
      batch.shapes.push_back(shapes[i]);
    }
    batch.states.push_back(state);
    sent_[rank].push_back(i);
  }
  told.resize(batch.states.size());
  channel_->send(rank, encode(batch), {timeout_, "it to take our states"});
}

std::uint32_t SolidSession::add_loads(int rank) {
  const StepHeader& head = head_;
  const auto batch = decode<LoadBatch>(
      channel_->receive(rank, {timeout_, format("the loads of interval {}", head.interval)}));
  expect_interval(batch.head, head.interval, *channel_, rank);
  if (batch.loads.size() != sent_[rank].size())
    throw BadMessage(format("fluid rank {} answered {} loads for {} particles at interval {}", rank,
                            batch.loads.size(), sent_[rank].size(), head.interval));
  for (std::size_t i = 0; i < batch.loads.size(); ++i) {
    const Load& part = batch.loads[i];
    Load& sum = loads_[sent_[rank][i]];
    if (part.id != sum.id)
      throw BadMessage(format("fluid rank {} answered a load for {} in place of {}", rank,
                              name_of(part.id), name_of(sum.id)));
    expect_finite(part, part.force, "hydrodynamic force", head.interval);
    expect_finite(part, part.torque, "hydrodynamic torque", head.interval);
    for (int k = 0; k < 3; ++k) {
      sum.force[k] += part.force[k];
      sum.torque[k] += part.torque[k];
    }
  }
  return batch.head.flags;
}

void SolidSession::goodbye(const std::string& reason) {
  for (int r = 0; r < channel_->remote_size(); ++r)
    channel_->send(r, encode(Goodbye{reason}), {timeout_, "it to take our goodbye"});
}

}  // namespace protocol
