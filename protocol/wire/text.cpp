// SPDX-License-Identifier: MIT
#include "protocol/wire/text.h"

#include <array>
#include <cmath>

namespace protocol::detail {

std::string_view take_field(std::string_view& pattern, std::string& result) {
  const std::size_t open = pattern.find('{'), close = pattern.find('}', open);
  std::string_view how = pattern.substr(open + 1, close - open - 1);
  if (how.starts_with(':')) how.remove_prefix(1);
  result.append(pattern.substr(0, open));
  pattern.remove_prefix(close + 1);
  return how;
}

void put(std::string& result, std::string_view text, std::string_view /*how*/) {
  result.append(text);
}

void put(std::string& result, char value, std::string_view /*how*/) {
  result.push_back(value);
}

/// The fewest digits that are read as the same number; with an exponent where it is very large or
/// very small.
void put_all_digits(std::string& result, double value) {
  std::array<char, 400> text;
  const double size = std::abs(value);
  const bool plain = size == 0.0 || (size >= 1e-4 && size < 1e16);
  const auto form = plain ? std::chars_format::fixed : std::chars_format::scientific;
  result.append(text.data(),
                std::to_chars(text.data(), text.data() + text.size(), value, form).ptr);
}

void put(std::string& result, double value, std::string_view how) {
  if (how.empty()) {
    put_all_digits(result, value);
    return;
  }
  std::array<char, 64> text;
  const std::string conversion = "%" + std::string(how);
  const int size = std::snprintf(text.data(), text.size(), conversion.c_str(), value);
  result.append(text.data(), static_cast<std::size_t>(size));
}

}  // namespace protocol::detail
