// SPDX-License-Identifier: MIT
/// Text from patterns, for messages: the part of std::format that they need, which the compilers in
/// use do not have yet. The library needs nothing else than MPI for it.
#pragma once

#include <charconv>
#include <concepts>
#include <cstddef>
#include <cstdio>
#include <ranges>
#include <string>
#include <string_view>

namespace protocol {

namespace detail {

/// Takes the text before the next field and the field itself off a pattern.
/// @return what the field says after its colon, e.g. ".6g"
std::string_view take_field(std::string_view& pattern, std::string& result);

void put(std::string& result, std::string_view text, std::string_view how);
void put(std::string& result, double value, std::string_view how);
void put(std::string& result, char value, std::string_view how);
template <std::integral Whole>
void put(std::string& result, Whole value, std::string_view how) {
  char digits[24];
  const auto end = std::to_chars(digits, digits + sizeof digits, value, how == "x" ? 16 : 10).ptr;
  result.append(digits, end);
}

constexpr std::size_t fields(std::string_view pattern) {
  std::size_t count = 0;
  for (const char c : pattern) count += c == '{' ? 1 : 0;
  return count;
}
void pattern_has_another_number_of_fields();  // not defined: ends the compilation

}  // namespace detail

/// A pattern whose fields `{}` or `{:HOW}` were counted when the program was compiled.
template <std::size_t Fields>
class Pattern {
 public:
  template <std::convertible_to<std::string_view> Text>
  consteval Pattern(const Text& text) : text_(text) {  // NOLINT: implicit, as a text is
    if (detail::fields(text_) != Fields) detail::pattern_has_another_number_of_fields();
  }
  constexpr std::string_view text() const { return text_; }

 private:
  std::string_view text_;
};

/// The pattern with an argument in place of each field: `{}` as it is, a number with as many digits
/// as it needs; `{:.6g}` a number as printf writes it; `{:x}` a whole number with base 16.
template <class... Args>
std::string format(Pattern<sizeof...(Args)> pattern, const Args&... args) {
  std::string result;
  std::string_view rest = pattern.text();
  result.reserve(rest.size() + 8 * sizeof...(Args));
  (
      [&](const auto& argument) {
        const std::string_view how = detail::take_field(rest, result);
        detail::put(result, argument, how);
      }(args),
      ...);
  return result.append(rest);
}

/// The items with a text between them.
template <std::ranges::input_range Items>
std::string join(const Items& items, std::string_view between) {
  std::string result;
  for (const auto& item : items) {
    if (!result.empty()) result += between;
    detail::put(result, item, {});
  }
  return result;
}

/// Writes a pattern with its arguments to a stream.
template <class... Args>
void print(std::FILE* file, Pattern<sizeof...(Args)> pattern, const Args&... args) {
  const std::string text = format(pattern, args...);
  std::fwrite(text.data(), 1, text.size(), file);
}

}  // namespace protocol
