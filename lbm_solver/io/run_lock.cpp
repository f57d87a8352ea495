// SPDX-License-Identifier: GPL-2.0-or-later
#include "lbm_solver/io/run_lock.h"

#include <fcntl.h>
#include <fmt/core.h>
#include <signal.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <sstream>

#include "lbm_solver/base/errors.h"

namespace lbm {
namespace {

constexpr const char* kName = "/.bplbm.lock";

std::string host() {
  std::array<char, 256> name{};
  gethostname(name.data(), name.size() - 1);
  return name.data();
}

struct Owner {
  long pid = 0;
  std::string host;
};

/// Whom the text of a lock names; nobody where it is empty.
Owner owner_of(int file) {
  std::array<char, 512> text{};
  if (pread(file, text.data(), text.size() - 1, 0) <= 0) return {};
  Owner owner;
  std::istringstream(text.data()) >> owner.pid >> owner.host;
  return owner;
}

bool lives(long pid) {
  return pid > 0 && (kill(static_cast<pid_t>(pid), 0) == 0 || errno == EPERM);
}

}  // namespace

RunLock::RunLock(const std::string& folder) : path_(folder + kName) {
  do {
    if (file_ >= 0) close(file_);
    file_ = open(path_.c_str(), O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW, 0644);
    if (file_ < 0)
      throw InputError(path_, std::strerror(errno), "give a folder that is writable as --out");
    const bool locked = flock(file_, LOCK_EX | LOCK_NB) == 0;
    try {
      refuse_if_held(locked, locked || errno == EWOULDBLOCK);
    } catch (...) {
      close(file_);
      throw;
    }
  } while (!is_in_place());  // its owner removed it after we had opened it
  const std::string text = fmt::format("{} {}\n", getpid(), host());
  if (ftruncate(file_, 0) != 0 || pwrite(file_, text.data(), text.size(), 0) < 0) {
    const std::string reason = std::strerror(errno);
    close(file_);
    throw InputError(path_, reason, "is the disk full?");
  }
}

RunLock::~RunLock() {
  if (is_in_place()) unlink(path_.c_str());  // before it is free, or it might be another's
  close(file_);
}

void RunLock::moved_to(const std::string& folder) {
  path_ = folder + kName;
}

void RunLock::refuse_if_held(bool locked, bool locks_work) const {
  const Owner owner = owner_of(file_);
  const bool elsewhere = !owner.host.empty() && owner.host != host();
  if (elsewhere)
    throw InputError(
        path_.substr(0, path_.size() - std::strlen(kName)),
        fmt::format("process {} on host {} writes into it, or was killed", owner.pid, owner.host),
        fmt::format("give another --out; if that run has ended, delete {}", path_));
  if (locked || (!locks_work && !lives(owner.pid))) return;
  throw InputError(path_.substr(0, path_.size() - std::strlen(kName)),
                   fmt::format("another run writes into it: process {} on this host", owner.pid),
                   "wait for its end, or give another --out");
}

/// The open file is still the one of that name.
bool RunLock::is_in_place() const {
  struct stat ours {
  }, named{};
  return fstat(file_, &ours) == 0 && stat(path_.c_str(), &named) == 0 &&
         ours.st_dev == named.st_dev && ours.st_ino == named.st_ino;
}

}  // namespace lbm
