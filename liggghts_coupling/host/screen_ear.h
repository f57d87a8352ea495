// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <cstdio>
#include <functional>
#include <string>
#include <utility>

namespace dem {

/// Stands between LIGGGHTS and its screen: passes on what is written, remembers the last error (a
/// line that begins with ERROR, and those behind it up to the place in the source), and tells of
/// each that begins with WARNING. What one process says goes to the screen alone, in no log.
class ScreenEar {
 public:
  /// What LIGGGHTS is to write to. It closes it; this object must live until then.
  /// @param screen  where it goes on to, not closed; null: nowhere
  /// @return null where the system has no memory for a stream
  std::FILE* listen(std::FILE* screen);

  /// @param tell  called with each line that begins with WARNING, without its end
  void tell_warnings(std::function<void(const std::string&)> tell) { tell_ = std::move(tell); }

  /// In one line.
  const std::string& last_error() const { return last_error_; }

 private:
  void take(const char* text, std::size_t size);
  void hear(const std::string& line);

  std::FILE* screen_ = nullptr;
  std::function<void(const std::string&)> tell_;
  std::string line_, last_error_;
  int lines_to_come_ = 0;  // of the last error, at most
};

/// A line of LIGGGHTS without the place in its source, which ends it: " (pair.cpp:12)".
std::string without_source(const std::string& error);

/// What to do about an error of LIGGGHTS that does not say it; empty where it does, or nobody
/// knows.
std::string advice_for(const std::string& error);

}  // namespace dem
