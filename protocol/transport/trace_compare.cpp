// SPDX-License-Identifier: MIT
#include "protocol/transport/trace_compare.h"

#include <cmath>
#include <limits>
#include <map>
#include <stdexcept>
#include <unordered_map>

#include "protocol/wire/text.h"

namespace protocol {
namespace {

double norm(const Vec3& v) {
  return std::hypot(v[0], v[1], v[2]);
}

/// Orders records by id and folds those of the same particle into its first one.
template <class Record, class Fold>
void merge_by_id(std::vector<Record>& records, Fold&& fold) {
  std::stable_sort(records.begin(), records.end(),
                   [](const Record& a, const Record& b) { return a.id < b.id; });
  std::size_t kept = 0;
  for (std::size_t i = 1; i < records.size(); ++i)
    if (records[i].id == records[kept].id)
      fold(records[kept], records[i]);
    else
      records[++kept] = records[i];
  if (!records.empty()) records.resize(kept + 1);
}

/// A particle that two fluid ranks were told of is one particle.
void keep_first(State&, const State&) {}

/// Parts of one load from several fluid ranks add up, in the order of the frames.
void add_part(Load& sum, const Load& part) {
  for (int k = 0; k < 3; ++k) {
    sum.force[k] += part.force[k];
    sum.torque[k] += part.torque[k];
  }
}

template <class Record>
void append(std::vector<Record>& records, std::span<const Record> more) {
  records.insert(records.end(), more.begin(), more.end());
}

}  // namespace

std::vector<IntervalRecord> timeline(const Trace& trace) {
  std::map<std::int64_t, IntervalRecord> intervals;
  std::unordered_map<std::int64_t, Shape> shapes;
  for (const FrameRow& row : trace.frames()) {
    if (row.kind != Kind::States && row.kind != Kind::Loads) continue;
    IntervalRecord& record = intervals[row.interval];
    if (row.kind == Kind::Loads) {
      record.load_flags |= row.flags;
      append(record.loads, trace.loads(row));
      continue;
    }
    record.head = {row.interval, row.time, row.flags};
    record.setting = row.setting;
    append(record.states, trace.states(row));
    for (const Shape& s : trace.shapes(row)) shapes[s.id] = s;
  }
  std::vector<IntervalRecord> result;
  for (auto& [interval, record] : intervals) {
    merge_by_id(record.states, keep_first);
    merge_by_id(record.loads, add_part);
    for (const State& s : record.states) {
      const auto shape = shapes.find(s.id);
      if (shape == shapes.end())
        throw std::runtime_error(format("the trace never tells the shape of {}", s.id));
      record.shapes.push_back(shape->second);
    }
    result.push_back(std::move(record));
  }
  return result;
}

TraceComparison::TraceComparison(std::span<const IntervalRecord> scale) {
  double radius = 0.0;
  for (const auto& record : scale) {
    for (const Shape& s : record.shapes) radius = std::max(radius, s.radius);
    for (const State& s : record.states) {
      x_ = std::max(x_, norm(s.x));
      v_ = std::max(v_, norm(s.v));
      omega_ = std::max(omega_, norm(s.omega));
    }
    for (const Load& l : record.loads) {
      force_ = std::max(force_, norm(l.force));
      torque_ = std::max(torque_, norm(l.torque));
    }
  }
  if (radius == 0.0) return;
  // What symmetry makes zero is round-off; its own size is no scale. A millionth of what force and
  // torque, velocity and spin amount to by the other is.
  constexpr double part = 1e-6;
  const double force = std::max(force_, part * torque_ / radius),
               v = std::max(v_, part * omega_ * radius);
  torque_ = std::max(torque_, part * force_ * radius);
  omega_ = std::max(omega_, part * v_ / radius);
  force_ = force;
  v_ = v;
}

void TraceComparison::vectors(std::int64_t interval, std::int64_t id, const char* field,
                              const Vec3& a, const Vec3& b, double scale) {
  for (int k = 0; k < 3; ++k) {
    if (a[k] == b[k]) continue;
    if (!first_) first_ = {interval, id, format("{}[{}]", field, k), a[k], b[k]};
    const double relative = std::abs(a[k] - b[k]) / std::max(scale, 1e-300);
    largest_ = std::isfinite(relative) ? std::max(largest_, relative)
                                       : std::numeric_limits<double>::infinity();
  }
}

template <class Record, class Compare>
void TraceComparison::records(std::int64_t interval, std::span<const Record> a,
                              std::span<const Record> b, Compare&& compare) {
  for (std::size_t i = 0; i < std::max(a.size(), b.size()); ++i) {
    if (i < a.size() && i < b.size() && a[i].id == b[i].id) {
      compare(a[i], b[i]);
      continue;
    }
    const auto& present = i < a.size() ? a[i] : b[i];
    if (!first_)
      first_ = {interval, present.id, "particle is on one side only", static_cast<double>(a.size()),
                static_cast<double>(b.size())};
    largest_ = std::numeric_limits<double>::infinity();
    return;
  }
}

void TraceComparison::states(std::int64_t interval, std::span<const State> a,
                             std::span<const State> b) {
  records(interval, a, b, [&](const State& p, const State& q) {
    vectors(interval, p.id, "x", p.x, q.x, x_);
    vectors(interval, p.id, "v", p.v, q.v, v_);
    vectors(interval, p.id, "omega", p.omega, q.omega, omega_);
  });
}

void TraceComparison::loads(std::int64_t interval, std::span<const Load> a,
                            std::span<const Load> b) {
  records(interval, a, b, [&](const Load& p, const Load& q) {
    vectors(interval, p.id, "force", p.force, q.force, force_);
    vectors(interval, p.id, "torque", p.torque, q.torque, torque_);
  });
}

std::string TraceComparison::text() const {
  if (!first_) return "identical, bit for bit";
  return format(
      "first difference at interval {}, particle {}, {}: {:.17g} against {:.17g}; largest relative "
      "difference {:.3g}",
      first_->interval, first_->id, first_->field, first_->a, first_->b, largest_);
}

}  // namespace protocol
