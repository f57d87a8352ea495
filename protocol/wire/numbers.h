// SPDX-License-Identifier: MIT
/// Numbers from text that a user wrote. std::atof and std::atoi take "10x" for 10 and "x" for 0.
#pragma once

#include <charconv>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <optional>
#include <string>
#include <string_view>

#include "protocol/wire/errors.h"

namespace protocol {

/// The whole text as a number of the type; nothing where it is none, or not finite.
template <class Number>
std::optional<Number> to_number(std::string_view text) {
  if (text.starts_with('+') && !text.starts_with("+-")) text.remove_prefix(1);
  Number value{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  if constexpr (std::is_floating_point_v<Number>)
    if (!std::isfinite(value)) return std::nullopt;
  return value;
}

/// Seconds that an environment variable gives, or else `fallback`.
/// @throws ProgramError  it is set to something else than a number of at least 0
inline double seconds_from_environment(const char* name, double fallback) {
  const char* set = std::getenv(name);
  if (!set) return fallback;
  const auto seconds = to_number<double>(set);
  if (seconds && *seconds >= 0.0) return *seconds;
  throw ProgramError(std::string("the environment variable ") + name + " = '" + set +
                         "' is no time; give seconds, at least 0, or unset it",
                     kBadInput);
}

}  // namespace protocol
