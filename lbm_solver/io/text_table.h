// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <fstream>
#include <string>
#include <vector>

namespace lbm {

/// A table of numbers that a user wrote, or a spreadsheet on any system: lines of fields between
/// commas. What no eye sees is no part of it: the mark of UTF-8 at its beginning, carriage returns,
/// blanks around fields, and empty lines.
class TextTable {
 public:
  explicit TextTable(const std::string& path) : file_(path, std::ios::binary) {}

  /// Goes to the next line that holds something. @return false at the end
  bool next();
  /// The line without what no eye sees: "time,factor".
  const std::string& line() const { return line_; }
  /// Counted from 1, empty ones too.
  int number() const { return number_; }
  /// The beginning of the line as a message shows it: bytes that are no text are written out.
  std::string shown() const;
  /// The line's numbers; none where it is not `count` finite decimal numbers.
  std::vector<double> numbers(std::size_t count) const;

 private:
  std::ifstream file_;
  std::string line_;
  int number_ = 0;
};

}  // namespace lbm
