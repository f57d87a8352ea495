// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <fmt/core.h>

#include <cstdint>
#include <cstdio>
#include <memory>
#include <string>

namespace lbm {

/// What the program tells a user: on the terminal and in `lbm.log`. A line is
/// `step | part | sentence with value and unit`.
class Log {
 public:
  /// How the progress appears on the terminal: one line that is overwritten, or a line a tenth.
  enum class Progress { Line, Tenths, None };

  Log(const std::string& folder, Progress progress);
  /// Says nothing: for the ranks beside the first.
  Log() = default;

  template <class... Args>
  void say(std::int64_t step, const char* part, fmt::format_string<Args...> format,
           Args&&... args) {
    write(fmt::format("{:>9} | {:<8} | {}", step, part,
                      fmt::format(format, std::forward<Args>(args)...)));
  }
  /// Several lines as they are.
  void block(const std::string& text) { write(text); }

  /// @param done  fraction, 0 … 1
  void progress(double done, const std::string& text);

 private:
  void write(const std::string& line);
  struct Close {
    void operator()(std::FILE* f) const { std::fclose(f); }
  };
  std::unique_ptr<std::FILE, Close> file_;
  Progress progress_ = Progress::None;
  int tenth_ = 0;
  bool line_open_ = false;
};

}  // namespace lbm
