// SPDX-License-Identifier: GPL-2.0-or-later
#include "lbm_solver/io/log.h"

#include "lbm_solver/base/errors.h"

namespace lbm {

Log::Log(const std::string& folder, Progress progress)
    : file_(std::fopen((folder + "/lbm.log").c_str(), "w")), progress_(progress) {
  if (!file_) throw InputError(folder + "/lbm.log", "cannot be written", "choose another --out");
}

void Log::write(const std::string& line) {
  if (!file_) return;
  if (line_open_) std::fputs("\n", stdout);
  line_open_ = false;
  fmt::print("{}\n", line);
  fmt::print(file_.get(), "{}\n", line);
  std::fflush(stdout);
  std::fflush(file_.get());
}

void Log::progress(double done, const std::string& text) {
  if (progress_ == Progress::None) return;
  if (progress_ == Progress::Line) {
    fmt::print("\r{}\033[K", text);
    std::fflush(stdout);
    line_open_ = true;
    return;
  }
  const int tenth = static_cast<int>(done * 10.0 + 1e-9);
  if (tenth <= tenth_) return;
  tenth_ = tenth;
  write(text);
}

}  // namespace lbm
