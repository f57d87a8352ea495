// SPDX-License-Identifier: MIT
#include "protocol/wire/session.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstring>
#include <limits>
#include <numeric>
#include <utility>

#include "protocol/wire/agreement.h"
#include "protocol/wire/numbers.h"
#include "protocol/wire/routing.h"
#include "protocol/wire/text.h"

namespace protocol {
namespace {

/// Adds the life time of the object to `total`.
class Stopwatch {
 public:
  explicit Stopwatch(double& total) : total_(total) {}
  ~Stopwatch() {
    total_ += std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
  }
  Stopwatch(const Stopwatch&) = delete;
  Stopwatch& operator=(const Stopwatch&) = delete;

 private:
  double& total_;
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

/// Both sides compute the disagreements and exchange them, so that both print the union.
void settle(Channel& channel, const Hello& fluid, const Hello& solid, const Wait& wait) {
  std::vector<std::string> reasons = disagreements(fluid, solid);
  const Bytes answer = encode(Answer{reasons.empty(), reasons});
  for (int r = 0; r < channel.remote_size(); ++r) channel.send(r, answer, wait);
  for (int r = 0; r < channel.remote_size(); ++r)
    for (const auto& reason : decode<Answer>(channel.receive(r, wait)).reasons)
      if (std::find(reasons.begin(), reasons.end(), reason) == reasons.end())
        reasons.push_back(reason);
  if (!reasons.empty()) throw Refusal(reasons);
}

bool finite(const Vec3& v) {
  return std::isfinite(v[0]) && std::isfinite(v[1]) && std::isfinite(v[2]);
}

[[noreturn]] void refuse_vector(std::int64_t id, const Vec3& value, const char* what,
                                std::int64_t interval) {
  throw BadMessage(format("particle {}: {} is ({}, {}, {}) at interval {}: not finite", id, what,
                          value[0], value[1], value[2], interval),
                   kNumerics);
}

/// @throws BadMessage where a vector of a record is not finite
template <class Record>
void expect_finite(const Record& record, const Vec3& value, const char* what,
                   std::int64_t interval) {
  if (!finite(value)) refuse_vector(record.id, value, what, interval);
}

[[noreturn]] void refuse_load(std::int64_t id, std::int64_t expected, std::int64_t interval) {
  throw ProtocolError(
      format("the fluid computed a load of particle {} in place of {} at interval {}", id, expected,
             interval));
}

[[noreturn]] void refuse_astray(const State& s, std::int64_t interval) {
  throw ProtocolError(
      format("particle {}: its centre ({:.6g}, {:.6g}, {:.6g}) m lies far outside of the box "
             "at interval {}; correct its place, or delete it",
             s.id, s.x[0], s.x[1], s.x[2], interval),
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

void expect_interval(const StepHeader& head, std::int64_t expected, const Channel& channel,
                     int rank) {
  if (head.interval != expected)
    throw BadMessage(format("{} rank {} sent interval {} where {} was expected",
                            channel.remote_name(), rank, head.interval, expected));
}

}  // namespace

// ---- fluid ----------------------------------------------------------------------------------

FluidSession::FluidSession(Channel& channel, Hello hello, double timeout)
    : channel_(channel),
      mine_(std::move(hello)),
      check_(mine_),
      timeout_(timeout),
      next_interval_(mine_.first_interval),
      order_(channel.remote_size()) {
  for (int r = 0; r < channel_.remote_size(); ++r)
    channel_.send(r, encode(mine_), {timeout_, "its mail box"});
}

const Hello& FluidSession::agree() {
  const Stopwatch watch(waited_);
  for (int r = 0; r < channel_.remote_size(); ++r) {
    const Bytes frame = channel_.receive(r, {timeout_, "its hello (end of its script's set-up)"});
    if (kind_of(frame) == Kind::Goodbye)
      throw PeerLeft(format("{} left before the coupling began: {}", channel_.remote_name(),
                            decode<Goodbye>(frame).reason));
    const Hello hello = decode<Hello>(frame);
    if (r == 0) partner_ = hello;
  }
  settle(channel_, mine_, partner_, {timeout_, "its answer to our hello"});
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
  for (const StateBatch& batch : batches)
    for (const Shape& shape : batch.shapes) {
      const auto known = shapes_.find(shape.id);
      check_.shape(shape, known == shapes_.end() ? nullptr : &known->second, next_interval_);
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
  return true;
}

namespace {

void add(SolidReport& sum, const SolidReport& part) {
  sum.grains_left += part.grains_left;
  sum.list.insert(sum.list.end(), part.list.begin(), part.list.end());
  if (!part.bonds) return;
  if (!sum.bonds) sum.bonds.emplace();
  for (const auto count : {&BondCounts::intact, &BondCounts::tension, &BondCounts::shear,
                           &BondCounts::left, &BondCounts::lost})
    (*sum.bonds).*count += (*part.bonds).*count;
}

}  // namespace

void FluidSession::merge_reports(const std::vector<StateBatch>& batches) {
  arrival_.report.reset();
  for (const StateBatch& batch : batches) {
    if (!batch.report) continue;
    if (!arrival_.report) arrival_.report.emplace();
    add(*arrival_.report, *batch.report);
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
    lightest_ = std::min(lightest_, now.shape.mass);
    while (old != before.end() && old->state.id < now.state.id) ++old;
    const bool same =
        old != before.end() && old->state.id == now.state.id && old->shape.epoch == now.shape.epoch;
    if (same)
      check_.next_state(now.state, now.shape, old->state, next_interval_);
    else
      check_.first_state(now, next_interval_);
    is_new.push_back(std::binary_search(told.begin(), told.end(), now.state.id));
  }
  if (!told.empty()) check_.overlaps(arrival_.particles, is_new, next_interval_);
}

void FluidSession::merge(const std::vector<StateBatch>& batches) {
  arrival_.head = batches.front().head;
  arrival_.goodbye.reset();
  merge_reports(batches);
  if (merge_as_before(batches)) return;
  const auto told = learn_shapes(batches);
  struct Origin {
    std::int64_t id;
    std::size_t rank, record;
  };
  std::vector<Origin> origins;
  before_.assign(batches.size(), {});
  for (std::size_t r = 0; r < batches.size(); ++r)
    for (std::size_t i = 0; i < batches[r].states.size(); ++i) {
      origins.push_back({batches[r].states[i].id, r, i});
      before_[r].push_back(batches[r].states[i].id);
    }
  std::sort(origins.begin(), origins.end(),
            [](const Origin& a, const Origin& b) { return a.id < b.id; });
  const std::vector<Particle> last = std::exchange(arrival_.particles, {});
  ids_.clear();
  for (std::size_t r = 0; r < batches.size(); ++r) order_[r].resize(batches[r].states.size());
  std::unordered_map<std::int64_t, Shape> present;
  for (const Origin& o : origins) {
    const auto shape = shapes_.find(o.id);
    if (shape == shapes_.end())
      throw BadMessage(
          format("particle {} came without radius and mass at interval {}", o.id, next_interval_));
    if (!present.emplace(o.id, shape->second).second)
      throw BadMessage(format(
          "particle {} came twice at interval {}: each solid rank gives only those that it owns",
          o.id, next_interval_));
    order_[o.rank][o.record] = arrival_.particles.size();
    arrival_.particles.push_back({batches[o.rank].states[o.record], shape->second});
    ids_.push_back(o.id);
  }
  if (const auto twice = std::adjacent_find(told.begin(), told.end()); twice != told.end())
    throw BadMessage(
        format("two shapes of particle {} came at interval {}", *twice, next_interval_), kBadInput);
  for (const std::int64_t id : told)
    if (!present.contains(id))
      throw BadMessage(format("a shape of particle {} came at interval {}, but no state of it", id,
                              next_interval_),
                       kBadInput);
  shapes_ = std::move(present);  // a particle that vanished must introduce itself again
  check_states(last, told);
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

// ---- solid ----------------------------------------------------------------------------------

SolidSession::SolidSession(Channel& channel, double timeout)
    : channel_(&channel),
      timeout_(timeout),
      told_(channel.remote_size()),
      sent_(channel.remote_size()) {
  const Stopwatch watch(waited_);
  for (int r = 0; r < channel_->remote_size(); ++r) {
    fluid_.push_back(decode<Hello>(channel_->receive(r, {timeout_, "its hello"})));
    timeout_ = timeout_of(fluid_.back(), timeout_);
  }
}

void SolidSession::agree(const Hello& hello) {
  const Stopwatch watch(waited_);
  for (int r = 0; r < channel_->remote_size(); ++r)
    channel_->send(r, encode(hello), {timeout_, "it to take our hello"});
  setting_ = {hello.step, hello.box_lo, hello.box_hi};
  settle(*channel_, fluid_.front(), hello, {timeout_, "its answer to our hello"});
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
  sent_[rank].clear();
  for (std::size_t i = 0; i < states.size(); ++i) {
    const State& state = states[i];
    if (!touches(fluid_[rank], state.x, shapes[i].radius)) {
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
      throw BadMessage(format("fluid rank {} answered a load for particle {} in place of {}", rank,
                              part.id, sum.id));
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
