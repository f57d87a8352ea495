// SPDX-License-Identifier: MIT
#include "protocol/wire/session_parts.h"

#include <algorithm>

#include "protocol/wire/agreement.h"
#include "protocol/wire/codec.h"
#include "protocol/wire/names.h"

namespace protocol {

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

void refuse_vector(std::int64_t id, const Vec3& value, const char* what, std::int64_t interval) {
  throw BadMessage(format("{}: {} is ({}, {}, {}) at interval {}: not finite", name_of(id), what,
                          value[0], value[1], value[2], interval),
                   kNumerics);
}

void expect_interval(const StepHeader& head, std::int64_t expected, const Channel& channel,
                     int rank) {
  if (head.interval != expected)
    throw BadMessage(format("{} rank {} sent interval {} where {} was expected",
                            channel.remote_name(), rank, head.interval, expected));
}

}  // namespace protocol
