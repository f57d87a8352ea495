// SPDX-License-Identifier: MIT
/// What both sides of a session do alike; included by them alone.
#pragma once

#include <chrono>
#include <cmath>

#include "protocol/wire/channel.h"
#include "protocol/wire/messages.h"
#include "protocol/wire/text.h"

namespace protocol {

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
/// @throws Refusal where there is one
void settle(Channel& channel, const Hello& fluid, const Hello& solid, const Wait& wait);

/// @throws BadMessage where a rank's message is of another interval
void expect_interval(const StepHeader& head, std::int64_t expected, const Channel& channel,
                     int rank);

/// Says that a vector of a particle is not finite. @throws BadMessage
[[noreturn]] void refuse_vector(std::int64_t id, const Vec3& value, const char* what,
                                std::int64_t interval);

/// @throws BadMessage where a vector of a record is not finite
template <class Record>
void expect_finite(const Record& record, const Vec3& value, const char* what,
                   std::int64_t interval) {
  if (!(std::isfinite(value[0]) && std::isfinite(value[1]) && std::isfinite(value[2])))
    refuse_vector(record.id, value, what, interval);
}

}  // namespace protocol
