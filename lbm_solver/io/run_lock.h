// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <string>

namespace lbm {

/// A folder belongs to one run at a time: the file `.bplbm.lock` in it names the process and the
/// host that write there.
///
/// What counts is flock() on the file, held while the object lives: the system gives it back
/// however a process ends, so that after a kill nothing is to be cleaned up. On NFS Linux turns it
/// into a lock of the server, seen by all hosts, unless the folder is mounted with `nolock` or
/// `local_lock`; then, and where a file system knows no locks at all, the text is what is left.
/// Hence a text of another host is always respected, whether or not its process still lives: the
/// message says which file to delete.
class RunLock {
 public:
  /// @throws InputError  another run has the folder, or may have it
  explicit RunLock(const std::string& folder);
  ~RunLock();
  RunLock(const RunLock&) = delete;
  RunLock& operator=(const RunLock&) = delete;

  /// The folder has another name now.
  void moved_to(const std::string& folder);

 private:
  void refuse_if_held(bool locked, bool locks_work) const;
  bool is_in_place() const;

  std::string path_;
  int file_ = -1;
};

}  // namespace lbm
