// SPDX-License-Identifier: MIT
#pragma once

#include <atomic>
#include <string>
#include <thread>

#include "protocol/wire/codec.h"

namespace protocol {

/// Takes into memory what a library writes to a file whose name it is given. LIGGGHTS and LAMMPS do
/// not look whether their writes succeed: on a full disk they leave half a file and go on.
class FileCatcher {
 public:
  /// Makes a pipe with a name in the system's temporary folder. @param ending  of its name
  /// @throws ProgramError  the folder is not writable
  explicit FileCatcher(const std::string& ending = {});
  ~FileCatcher();
  FileCatcher(const FileCatcher&) = delete;
  FileCatcher& operator=(const FileCatcher&) = delete;

  const std::string& path() const { return path_; }
  /// What was written, once the library has closed the file.
  Bytes take();

 private:
  void read_until_done();

  std::string path_;
  int pipe_ = -1;
  Bytes bytes_;
  std::atomic<bool> done_ = false;
  std::thread reader_;
};

}  // namespace protocol
