// SPDX-License-Identifier: MIT
/// A trace as a list of intervals, and the comparison of two such lists.
#pragma once

#include <algorithm>
#include <array>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "protocol/transport/trace.h"

namespace protocol {

/// One interval, merged over the remote ranks and ordered by particle id.
struct IntervalRecord {
  StepHeader head;
  Setting setting;
  std::uint32_t load_flags = kContinue;
  std::vector<State> states;
  std::vector<Shape> shapes;  ///< of every state, also where only an earlier frame carried it
  std::vector<Load> loads;    ///< empty for the last interval
};

/// @throws std::runtime_error where the trace contradicts itself
std::vector<IntervalRecord> timeline(const Trace& trace);

/// What differences of each field are divided by.
struct Scales {
  double x = 0.0, v = 0.0, omega = 0.0, force = 0.0, torque = 0.0;
  Vec3 period{};  ///< places that differ by this are one place [m]; 0: none are
  bool physical = false;
};

/// The largest norm of each field; where symmetry leaves only round-off a millionth of what goes
/// with it.
Scales largest_norms(std::span<const IntervalRecord> exchange);

/// A place in radii, a velocity in the fastest, an angular velocity in the fastest over a radius, a
/// force in weights, a torque in weights times a radius; of the smallest and lightest particle.
/// Without gravity the largest load stands for the weight.
Scales physical_scales(std::span<const IntervalRecord> exchange, const Hello& fluid);

/// Where two exchanges differ first, and by how much at most.
class TraceComparison {
 public:
  /// @param scale  the exchange whose largest norms set what "relative" means
  explicit TraceComparison(std::span<const IntervalRecord> scale)
      : TraceComparison(largest_norms(scale)) {}
  /// @param tolerance  largest difference over the scale of its field that passes
  explicit TraceComparison(const Scales& scales, double tolerance = 0.0)
      : scale_(scales), tolerance_(tolerance) {}

  void states(std::int64_t interval, std::span<const State> a, std::span<const State> b);
  void loads(std::int64_t interval, std::span<const Load> a, std::span<const Load> b);

  struct Difference {
    std::int64_t interval = 0, id = 0;
    std::string field;
    double a = 0.0, b = 0.0;
  };
  const std::optional<Difference>& first() const { return first_; }
  /// The first above the tolerance, and the largest.
  const std::optional<Difference>& first_beyond() const { return beyond_; }
  const std::optional<Difference>& worst() const { return worst_; }
  /// Largest |a-b| over the scale of its field; infinite where a particle is missing.
  double largest() const;
  /// One sentence for a user.
  std::string text() const;

 private:
  template <class Record, class Compare>
  void records(std::int64_t interval, std::span<const Record> a, std::span<const Record> b,
               Compare&& compare);
  void vectors(std::int64_t interval, std::int64_t id, int field, const Vec3& a, const Vec3& b);

  void note(const Difference& difference, double relative);

  Scales scale_;
  double tolerance_ = 0.0, worst_relative_ = 0.0;
  std::optional<Difference> first_, beyond_, worst_;
  std::array<double, 5> largest_{};  // of x, v, omega, force, torque
};

}  // namespace protocol
