// SPDX-License-Identifier: MIT
#include "protocol/wire/session.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <unordered_set>
#include <utility>

#include "protocol/wire/names.h"
#include "protocol/wire/session_parts.h"
#include "protocol/wire/text.h"

namespace protocol {
namespace {

[[noreturn]] void refuse_load(std::int64_t id, std::int64_t expected, std::int64_t interval) {
  throw ProtocolError(format("the fluid computed a load of {} in place of {} at interval {}",
                             name_of(id), name_of(expected), interval));
}

}  // namespace

FluidSession::FluidSession(Channel& channel, Hello hello, double timeout)
    : channel_(channel),
      mine_(std::move(hello)),
      check_(mine_),
      clumps_(mine_),
      timeout_(timeout),
      next_interval_(mine_.first_interval),
      order_(channel.remote_size()) {
  for (int r = 0; r < channel_.remote_size(); ++r)
    channel_.send(r, encode(mine_), {timeout_, "its mail box"});
}

const Hello& FluidSession::agree() {
  const Stopwatch watch(waited_);
  for (int r = 0; r < channel_.remote_size(); ++r) {
    const Bytes frame =
        channel_.receive(r, {timeout_, "its handshake (end of its script's set-up)"});
    if (kind_of(frame) == Kind::Goodbye)
      throw PeerLeft(format("{} left before the coupling began: {}", channel_.remote_name(),
                            decode<Goodbye>(frame).reason));
    const Hello hello = decode<Hello>(frame);
    if (r == 0) partner_ = hello;
  }
  settle(channel_, mine_, partner_, {timeout_, "its answer to our handshake"});
  return partner_;
}

const Arrival& FluidSession::receive() {
  const Stopwatch watch(waited_);
  std::vector<StateBatch> batches;
  for (int r = 0; r < channel_.remote_size(); ++r) {
    const Bytes frame =
        channel_.receive(r, {timeout_, format("the states of interval {}", next_interval_)});
    if (kind_of(frame) == Kind::Goodbye) {
      arrival_ = {{next_interval_, 0.0, kLast}, {}, decode<Goodbye>(frame).reason, {}};
      continue;
    }
    batches.push_back(decode<StateBatch>(frame));
    expect_interval(batches.back().head, next_interval_, channel_, r);
    check_.setting(batches.back().setting, next_interval_);
  }
  if (batches.empty() && channel_.remote_size() > 0) return arrival_;
  if (static_cast<int>(batches.size()) != channel_.remote_size())
    throw BadMessage(format("some {} ranks left at interval {}, others did not",
                            channel_.remote_name(), next_interval_));
  merge(batches);
  ++next_interval_;
  return arrival_;
}

/// @return ids of the shapes that came, in order
std::vector<std::int64_t> FluidSession::learn_shapes(const std::vector<StateBatch>& batches) {
  std::vector<std::int64_t> told;
  std::unordered_set<std::int64_t> named;  // carriers of spheres that are told now
  for (const StateBatch& batch : batches)
    for (const Shape& shape : batch.shapes)
      if (is_part(shape)) named.insert(shape.carrier);
  for (const StateBatch& batch : batches)
    for (const Shape& shape : batch.shapes) {
      const auto known = shapes_.find(shape.id);
      const bool clump = clumps_.is_clump(shape.id) || named.contains(shape.id);
      check_.shape(shape, known == shapes_.end() ? nullptr : &known->second, clump, next_interval_);
      told.push_back(shape.id);
      shapes_[shape.id] = shape;
    }
  std::sort(told.begin(), told.end());
  return told;
}

/// The usual case, without any table: the same particles on the same ranks in the same order as in
/// the interval before, none of another shape.
bool FluidSession::merge_as_before(const std::vector<StateBatch>& batches) {
  for (std::size_t r = 0; r < batches.size(); ++r) {
    const auto same = [](const State& s, std::int64_t id) { return s.id == id; };
    if (before_.size() != batches.size() || !batches[r].shapes.empty() ||
        !std::equal(batches[r].states.begin(), batches[r].states.end(), before_[r].begin(),
                    before_[r].end(), same))
      return false;
  }
  for (std::size_t r = 0; r < batches.size(); ++r)
    for (std::size_t i = 0; i < batches[r].states.size(); ++i) {
      Particle& particle = arrival_.particles[order_[r][i]];
      check_.next_state(batches[r].states[i], particle.shape, particle.state, next_interval_);
      particle.state = batches[r].states[i];
    }
  if (!clumps_.none()) clumps_.places(arrival_.particles, next_interval_);
  return true;
}

namespace {

void add(std::int64_t& sum, std::int64_t count, const char* what, std::int64_t interval) {
  if (count < 0)
    throw BadMessage(format("the solid counts {} {} at interval {}: a number cannot be below 0",
                            count, what, interval),
                     kBadInput);
  sum += count;
}

void add(SolidReport& sum, const SolidReport& part, std::int64_t interval) {
  add(sum.grains_left, part.grains_left, "grains that have left", interval);
  sum.list.insert(sum.list.end(), part.list.begin(), part.list.end());
  if (!part.bonds) return;
  if (!sum.bonds) sum.bonds.emplace();
  for (const auto& [count, what] : {std::pair{&BondCounts::intact, "intact bonds"},
                                    {&BondCounts::tension, "bonds broken by tension"},
                                    {&BondCounts::shear, "bonds broken by shear"},
                                    {&BondCounts::left, "bonds that have left"},
                                    {&BondCounts::lost, "lost bonds"}})
    add((*sum.bonds).*count, (*part.bonds).*count, what, interval);
}

}  // namespace

void FluidSession::merge_reports(const std::vector<StateBatch>& batches) {
  arrival_.report.reset();
  for (const StateBatch& batch : batches) {
    if (!batch.report) continue;
    if (!arrival_.report) arrival_.report.emplace();
    add(*arrival_.report, *batch.report, next_interval_);
  }
}

/// @param before  particles of the interval before, by id
/// @param told  those whose shape came with this one
void FluidSession::check_states(std::span<const Particle> before,
                                std::span<const std::int64_t> told) {
  std::vector<char> is_new;
  lightest_ = std::numeric_limits<double>::infinity();
  auto old = before.begin();
  for (const Particle& now : arrival_.particles) {
    if (!is_part(now.shape)) lightest_ = std::min(lightest_, now.shape.mass);
    while (old != before.end() && old->state.id < now.state.id) ++old;
    const bool same =
        old != before.end() && old->state.id == now.state.id && old->shape.epoch == now.shape.epoch;
    if (same)
      check_.next_state(now.state, now.shape, old->state, next_interval_);
    else
      check_.first_state(now, next_interval_);
    is_new.push_back(std::binary_search(told.begin(), told.end(), now.state.id));
  }
  clumps_.learn(arrival_.particles, told, next_interval_);
  const auto is_clump = [this](std::int64_t id) { return clumps_.is_clump(id); };
  if (!told.empty()) check_.overlaps(arrival_.particles, is_new, is_clump, next_interval_);
}

namespace {

/// Where a state stands in the batches.
struct Origin {
  std::int64_t id;
  std::size_t rank, record;
};

/// Of all states, by id.
std::vector<Origin> origins_of(const std::vector<StateBatch>& batches) {
  std::vector<Origin> origins;
  for (std::size_t r = 0; r < batches.size(); ++r)
    for (std::size_t i = 0; i < batches[r].states.size(); ++i)
      origins.push_back({batches[r].states[i].id, r, i});
  std::sort(origins.begin(), origins.end(),
            [](const Origin& a, const Origin& b) { return a.id < b.id; });
  return origins;
}

}  // namespace

/// The particles of an interval in which others came than before, or with other shapes.
void FluidSession::merge_anew(const std::vector<StateBatch>& batches) {
  const auto told = learn_shapes(batches);
  before_.assign(batches.size(), {});
  for (std::size_t r = 0; r < batches.size(); ++r)
    for (const State& state : batches[r].states) before_[r].push_back(state.id);
  const std::vector<Particle> last = std::exchange(arrival_.particles, {});
  ids_.clear();
  for (std::size_t r = 0; r < batches.size(); ++r) order_[r].resize(batches[r].states.size());
  std::unordered_map<std::int64_t, Shape> present;
  for (const Origin& o : origins_of(batches)) {
    const auto shape = shapes_.find(o.id);
    if (shape == shapes_.end())
      throw BadMessage(
          format("{} came without radius and mass at interval {}", name_of(o.id), next_interval_));
    if (!present.emplace(o.id, shape->second).second)
      throw BadMessage(
          format("{} came twice at interval {}: each solid rank gives only those that it owns",
                 name_of(o.id), next_interval_));
    order_[o.rank][o.record] = arrival_.particles.size();
    arrival_.particles.push_back({batches[o.rank].states[o.record], shape->second});
    ids_.push_back(o.id);
  }
  if (const auto twice = std::adjacent_find(told.begin(), told.end()); twice != told.end())
    throw BadMessage(
        format("two shapes of {} came at interval {}", name_of(*twice), next_interval_), kBadInput);
  for (const std::int64_t id : told)
    if (!present.contains(id))
      throw BadMessage(format("a shape of {} came at interval {}, but no state of it", name_of(id),
                              next_interval_),
                       kBadInput);
  shapes_ = std::move(present);  // a particle that vanished must introduce itself again
  check_states(last, told);
}

void FluidSession::merge(const std::vector<StateBatch>& batches) {
  arrival_.head = batches.front().head;
  for (const StateBatch& batch : batches) arrival_.head.flags |= batch.head.flags & kStopWished;
  arrival_.goodbye.reset();
  merge_reports(batches);
  if (!merge_as_before(batches)) merge_anew(batches);
}

void FluidSession::answer(std::span<const Load> loads, std::uint32_t flags) {
  const StepHeader head{arrival_.head.interval, arrival_.head.time, flags};
  if (loads.size() != ids_.size())
    throw ProtocolError(format("the fluid computed {} loads for {} particles at interval {}",
                               loads.size(), ids_.size(), head.interval));
  double largest = 0.0;
  auto id = ids_.begin();
  for (const Load& load : loads) {
    if (load.id != *id) refuse_load(load.id, *id, head.interval);
    ++id;
    expect_finite(load, load.force, "hydrodynamic force", head.interval);
    expect_finite(load, load.torque, "hydrodynamic torque", head.interval);
    const auto& [x, y, z] = load.force;
    largest = std::max(largest, x * x + y * y + z * z);
  }
  check_.note_loads(std::sqrt(largest) / lightest_);
  for (int r = 0; r < channel_.remote_size(); ++r) {
    LoadBatch batch{head, {}};
    batch.loads.reserve(order_[r].size());
    for (const std::size_t index : order_[r]) batch.loads.push_back(loads[index]);
    channel_.send(r, encode(batch), {timeout_, "it to take its loads"});
  }
}

}  // namespace protocol
