// SPDX-License-Identifier: MIT
/// A trace as a list of intervals, and the comparison of two such lists.
#pragma once

#include <algorithm>
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

/// Where two exchanges differ first, and by how much at most.
class TraceComparison {
 public:
  /// @param scale  the exchange that sets what "relative" means: largest norm of each field in it,
  ///               where symmetry leaves only round-off a millionth of what goes with it
  explicit TraceComparison(std::span<const IntervalRecord> scale);

  void states(std::int64_t interval, std::span<const State> a, std::span<const State> b);
  void loads(std::int64_t interval, std::span<const Load> a, std::span<const Load> b);

  struct Difference {
    std::int64_t interval = 0, id = 0;
    std::string field;
    double a = 0.0, b = 0.0;
  };
  const std::optional<Difference>& first() const { return first_; }
  /// Largest |a-b| over the scale of its field; infinite where a particle is missing.
  double largest() const { return largest_; }
  /// One sentence for a user.
  std::string text() const;

 private:
  template <class Record, class Compare>
  void records(std::int64_t interval, std::span<const Record> a, std::span<const Record> b,
               Compare&& compare);
  void vectors(std::int64_t interval, std::int64_t id, const char* field, const Vec3& a,
               const Vec3& b, double scale);

  double x_ = 0.0, v_ = 0.0, omega_ = 0.0, force_ = 0.0, torque_ = 0.0;  // scales
  std::optional<Difference> first_;
  double largest_ = 0.0;
};

}  // namespace protocol
