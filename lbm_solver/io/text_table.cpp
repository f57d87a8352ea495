// SPDX-License-Identifier: GPL-2.0-or-later
#include "lbm_solver/io/text_table.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <string_view>

#include "protocol/wire/numbers.h"

namespace lbm {
namespace {

constexpr std::string_view kMark = "\xef\xbb\xbf";  // of UTF-8
constexpr std::string_view kBlank = " \t\r";
constexpr std::size_t kShown = 60;  // bytes of a line

std::string_view trimmed(std::string_view text) {
  const auto begin = text.find_first_not_of(kBlank);
  if (begin == std::string_view::npos) return {};
  return text.substr(begin, text.find_last_not_of(kBlank) + 1 - begin);
}

std::vector<std::string_view> fields(std::string_view line) {
  std::vector<std::string_view> all;
  for (std::size_t end = 0; end != std::string_view::npos; line.remove_prefix(end + 1)) {
    end = line.find(',');
    all.push_back(trimmed(line.substr(0, end)));
    if (end == std::string_view::npos) break;
  }
  return all;
}

}  // namespace

bool TextTable::next() {
  for (std::string raw; std::getline(file_, raw);) {
    std::string_view text = raw;
    if (++number_ == 1 && text.starts_with(kMark)) text.remove_prefix(kMark.size());
    line_ = fmt::format("{}", fmt::join(fields(text), ","));
    if (!line_.empty()) return true;
  }
  line_.clear();
  return false;
}

std::string TextTable::shown() const {
  std::string text;
  for (const char c : line_.substr(0, kShown)) {
    const auto byte = static_cast<unsigned char>(c);
    const bool seen = byte >= ' ' && byte != 127 && byte < 0xf8;  // above, none is of UTF-8
    text += c == '\t' ? "\\t" : seen ? std::string(1, c) : fmt::format("\\x{:02x}", byte);
  }
  return line_.size() > kShown ? text + "…" : text;
}

std::vector<double> TextTable::numbers(std::size_t count) const {
  std::vector<double> values;
  for (const std::string_view field : fields(line_)) {
    const auto value = protocol::to_number<double>(field);
    if (!value) return {};
    values.push_back(*value);
  }
  return values.size() == count ? values : std::vector<double>();
}

}  // namespace lbm
