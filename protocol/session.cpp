// SPDX-License-Identifier: MIT
#include "protocol/session.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstring>
#include <numeric>

#include "protocol/agreement.h"
#include "protocol/numbers.h"
#include "protocol/routing.h"

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

/// @throws BadMessage where a vector of a record is not finite
template <class Record>
void expect_finite(const Record& record, const Vec3& value, const char* what,
                   std::int64_t interval) {
  if (!finite(value))
    throw BadMessage(fmt::format("particle {}: {} is ({}, {}, {}) at interval {}: not finite",
                                 record.id, what, value[0], value[1], value[2], interval),
                     kNumerics);
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
    throw BadMessage(fmt::format("{} rank {} sent interval {} where {} was expected",
                                 channel.remote_name(), rank, head.interval, expected));
}

}  // namespace

// ---- fluid ----------------------------------------------------------------------------------

FluidSession::FluidSession(Channel& channel, Hello hello, double timeout)
    : channel_(channel),
      mine_(std::move(hello)),
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
      throw PeerLeft(fmt::format("{} left before the coupling began: {}", channel_.remote_name(),
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
        channel_.receive(r, {timeout_, fmt::format("the states of interval {}", next_interval_)});
    if (kind_of(frame) == Kind::Goodbye) {
      arrival_ = {{next_interval_, 0.0, kLast}, {}, decode<Goodbye>(frame).reason, {}};
      continue;
    }
    batches.push_back(decode<StateBatch>(frame));
    expect_interval(batches.back().head, next_interval_, channel_, r);
  }
  if (batches.empty() && channel_.remote_size() > 0) return arrival_;
  if (static_cast<int>(batches.size()) != channel_.remote_size())
    throw BadMessage(fmt::format("some {} ranks left at interval {}, others did not",
                                 channel_.remote_name(), next_interval_));
  merge(batches);
  ++next_interval_;
  return arrival_;
}

void FluidSession::learn_shapes(const StateBatch& batch) {
  for (const Shape& shape : batch.shapes) {
    const bool sound = std::isfinite(shape.radius) && shape.radius > 0.0 &&
                       std::isfinite(shape.mass) && shape.mass > 0.0 &&
                       std::isfinite(shape.inertia) && shape.inertia > 0.0;
    if (!sound)
      throw BadMessage(
          fmt::format("particle {}: radius {} m, mass {} kg, inertia {} kg m² must be "
                      "positive (interval {})",
                      shape.id, shape.radius, shape.mass, shape.inertia, batch.head.interval),
          kBadInput);
    shapes_[shape.id] = shape;
  }
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
    for (std::size_t i = 0; i < batches[r].states.size(); ++i)
      arrival_.particles[order_[r][i]].state = batches[r].states[i];
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

void FluidSession::expect_finite_states() const {
  for (const auto& [s, shape] : arrival_.particles) {
    expect_finite(s, s.x, "position", next_interval_);
    expect_finite(s, s.v, "velocity", next_interval_);
    expect_finite(s, s.omega, "angular velocity", next_interval_);
  }
}

void FluidSession::merge(const std::vector<StateBatch>& batches) {
  arrival_.head = batches.front().head;
  arrival_.goodbye.reset();
  merge_reports(batches);
  if (merge_as_before(batches)) return expect_finite_states();
  for (const auto& batch : batches) learn_shapes(batch);
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
  arrival_.particles.clear();
  for (std::size_t r = 0; r < batches.size(); ++r) order_[r].resize(batches[r].states.size());
  std::unordered_map<std::int64_t, Shape> present;
  for (const Origin& o : origins) {
    const auto shape = shapes_.find(o.id);
    if (shape == shapes_.end())
      throw BadMessage(fmt::format("particle {} came without radius and mass at interval {}", o.id,
                                   next_interval_));
    if (!present.emplace(o.id, shape->second).second)
      throw BadMessage(fmt::format("particle {} came twice at interval {}", o.id, next_interval_));
    order_[o.rank][o.record] = arrival_.particles.size();
    arrival_.particles.push_back({batches[o.rank].states[o.record], shape->second});
  }
  shapes_ = std::move(present);  // a particle that vanished must introduce itself again
  expect_finite_states();
}

void FluidSession::answer(std::span<const Load> loads, std::uint32_t flags) {
  const StepHeader head{arrival_.head.interval, arrival_.head.time, flags};
  for (const Load& load : loads) {
    expect_finite(load, load.force, "hydrodynamic force", head.interval);
    expect_finite(load, load.torque, "hydrodynamic torque", head.interval);
  }
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
  StateBatch batch{head, {}, {}, report};
  batch.states.reserve(states.size());
  const std::vector<Shape> told = std::move(told_[rank]);
  std::unordered_map<std::int64_t, const Shape*> by_id;  // only where the order has changed
  const auto told_of = [&](std::size_t place, std::int64_t id) -> const Shape* {
    if (place < told.size() && told[place].id == id) return &told[place];
    if (by_id.empty())
      for (const Shape& s : told) by_id.emplace(s.id, &s);
    const auto found = by_id.find(id);
    return found == by_id.end() ? nullptr : found->second;
  };
  told_[rank].clear();
  sent_[rank].clear();
  for (std::size_t i = 0; i < states.size(); ++i) {
    if (!touches(fluid_[rank], states[i].x, shapes[i].radius)) continue;
    const Shape* known = told_of(batch.states.size(), states[i].id);
    if (!known || std::memcmp(known, &shapes[i], sizeof(Shape)) != 0)
      batch.shapes.push_back(shapes[i]);
    batch.states.push_back(states[i]);
    sent_[rank].push_back(i);
    told_[rank].push_back(shapes[i]);
  }
  channel_->send(rank, encode(batch), {timeout_, "it to take our states"});
}

std::uint32_t SolidSession::add_loads(int rank) {
  const StepHeader& head = head_;
  const auto batch = decode<LoadBatch>(
      channel_->receive(rank, {timeout_, fmt::format("the loads of interval {}", head.interval)}));
  expect_interval(batch.head, head.interval, *channel_, rank);
  if (batch.loads.size() != sent_[rank].size())
    throw BadMessage(fmt::format("fluid rank {} answered {} loads for {} particles at interval {}",
                                 rank, batch.loads.size(), sent_[rank].size(), head.interval));
  for (std::size_t i = 0; i < batch.loads.size(); ++i) {
    const Load& part = batch.loads[i];
    Load& sum = loads_[sent_[rank][i]];
    if (part.id != sum.id)
      throw BadMessage(fmt::format("fluid rank {} answered a load for particle {} in place of {}",
                                   rank, part.id, sum.id));
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
