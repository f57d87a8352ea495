// SPDX-License-Identifier: GPL-2.0-or-later
/// Starting real programs from a test: always with a time limit, always cleaned up.
#pragma once

#include <string>
#include <vector>

namespace test {

struct JobResult {
  int exit_code = -1;      ///< 128 + signal where a signal ended it
  bool timed_out = false;  ///< it was killed, with everything it had started
  std::string output;      ///< stdout and stderr together
};

/// Runs a shell command in `folder`.
/// (The limit is BPLBM_PATIENCE times as long, see tests/CMakeLists.txt.)
JobResult run(const std::string& command, const std::string& folder, double limit_seconds);

/// A fresh, empty folder of this test; removed when the object dies.
class TemporaryFolder {
 public:
  TemporaryFolder();
  ~TemporaryFolder();
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
  const std::string& path() const { return path_; }
  /// Writes a file into the folder. @return its path
  std::string write(const std::string& name, const std::string& text) const;

 private:
  std::string path_;
};

std::string read_file(const std::string& path);

/// Rows of numbers of a table of a run, without the line of their names.
std::vector<std::vector<double>> read_rows(const std::string& path);

/// Text with every occurrence of `from` replaced; fails the test where there is none.
std::string replaced(std::string text, const std::string& from, const std::string& to);

}  // namespace test
