// SPDX-License-Identifier: MIT
#include "protocol/transport/trace_compare.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <stdexcept>
#include <unordered_map>

#include "protocol/wire/names.h"
#include "protocol/wire/text.h"

namespace protocol {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

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
        throw std::runtime_error(format("the trace never tells the shape of {}", name_of(s.id)));
      record.shapes.push_back(shape->second);
    }
    result.push_back(std::move(record));
  }
  return result;
}

namespace {

struct Extremes {
  double x = 0.0, v = 0.0, omega = 0.0, force = 0.0, torque = 0.0;  ///< largest norms
  double largest_radius = 0.0, radius = kInfinity, mass = kInfinity;
};

Extremes extremes(std::span<const IntervalRecord> exchange) {
  Extremes e;
  for (const auto& record : exchange) {
    for (const Shape& s : record.shapes) {
      e.largest_radius = std::max(e.largest_radius, s.radius);
      e.radius = std::min(e.radius, s.radius);
      e.mass = std::min(e.mass, s.mass);
    }
    for (const State& s : record.states) {
      e.x = std::max(e.x, norm(s.x));
      e.v = std::max(e.v, norm(s.v));
      e.omega = std::max(e.omega, norm(s.omega));
    }
    for (const Load& l : record.loads) {
      e.force = std::max(e.force, norm(l.force));
      e.torque = std::max(e.torque, norm(l.torque));
    }
  }
  return e;
}

constexpr const char* kFields[] = {"x", "v", "omega", "force", "torque"};

}  // namespace

Scales largest_norms(std::span<const IntervalRecord> exchange) {
  const Extremes e = extremes(exchange);
  if (e.largest_radius == 0.0) return {e.x, e.v, e.omega, e.force, e.torque, {}, false};
  // What symmetry makes zero is round-off; its own size is no scale. A millionth of what force and
  // torque, velocity and spin amount to by the other is.
  constexpr double part = 1e-6;
  const double r = e.largest_radius;
  return {e.x,
          std::max(e.v, part * e.omega * r),
          std::max(e.omega, part * e.v / r),
          std::max(e.force, part * e.torque / r),
          std::max(e.torque, part * e.force * r),
          {},
          false};
}

Scales physical_scales(std::span<const IntervalRecord> exchange, const Hello& fluid) {
  const Extremes e = extremes(exchange);
  Scales scale = largest_norms(exchange);
  scale.physical = true;
  for (int k = 0; k < 3; ++k)
    if (fluid.periodic[k]) scale.period[k] = fluid.box_hi[k] - fluid.box_lo[k];
  if (e.largest_radius == 0.0) return scale;  // no particle, no difference
  const double weight = e.mass * norm(fluid.gravity);
  scale.x = e.radius;
  scale.omega = std::max(scale.omega, scale.v / e.radius);
  if (weight > 0.0) scale.force = weight;
  scale.torque = scale.force * e.radius;
  return scale;
}

double TraceComparison::largest() const {
  return *std::max_element(largest_.begin(), largest_.end());
}

void TraceComparison::vectors(std::int64_t interval, std::int64_t id, int field, const Vec3& a,
                              const Vec3& b) {
  const double scales[] = {scale_.x, scale_.v, scale_.omega, scale_.force, scale_.torque};
  for (int k = 0; k < 3; ++k) {
    if (a[k] == b[k]) continue;
    double way = a[k] - b[k];
    if (field == 0 && scale_.period[k] > 0.0) way = std::remainder(way, scale_.period[k]);
    if (way == 0.0) continue;
    const double quotient = std::abs(way) / std::max(scales[field], 1e-300);
    const double relative = std::isfinite(quotient) ? quotient : kInfinity;
    note({interval, id, format("{}[{}]", kFields[field], k), a[k], b[k]}, relative);
    largest_[field] = std::max(largest_[field], relative);
  }
}

void TraceComparison::note(const Difference& difference, double relative) {
  if (!first_) first_ = difference;
  if (!beyond_ && relative > tolerance_) beyond_ = difference;
  if (relative <= worst_relative_) return;
  worst_relative_ = relative;
  worst_ = difference;
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
    note({interval, present.id, "particle is on one side only", static_cast<double>(a.size()),
          static_cast<double>(b.size())},
         kInfinity);
    largest_.fill(kInfinity);
    return;
  }
}

void TraceComparison::states(std::int64_t interval, std::span<const State> a,
                             std::span<const State> b) {
  records(interval, a, b, [&](const State& p, const State& q) {
    vectors(interval, p.id, 0, p.x, q.x);
    vectors(interval, p.id, 1, p.v, q.v);
    vectors(interval, p.id, 2, p.omega, q.omega);
  });
}

void TraceComparison::loads(std::int64_t interval, std::span<const Load> a,
                            std::span<const Load> b) {
  records(interval, a, b, [&](const Load& p, const Load& q) {
    vectors(interval, p.id, 3, p.force, q.force);
    vectors(interval, p.id, 4, p.torque, q.torque);
  });
}

std::string TraceComparison::text() const {
  if (!first_) return "identical, bit for bit";
  const auto place = [](const char* which, const Difference& d) {
    return format("{} at interval {}, {}, {}: {:.17g} against {:.17g}; ", which, d.interval,
                  name_of(d.id), d.field, d.a, d.b);
  };
  std::string first = place("first difference", *first_);
  if (tolerance_ > 0.0 && beyond_) first += place("first beyond the tolerance", *beyond_);
  if (worst_) first += place("largest", *worst_);
  if (!scale_.physical) return first + format("largest relative difference {:.3g}", largest());
  const auto& [x, v, omega, force, torque] = largest_;
  return first +
         format(
             "largest differences: {:.3g} radii in place, {:.3g} of the fastest in "
             "velocity ({:.3g} in angular velocity), {:.3g} weights in force ({:.3g} in torque)",
             x, v, omega, force, torque);
}

}  // namespace protocol
