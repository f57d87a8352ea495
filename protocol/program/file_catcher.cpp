// SPDX-License-Identifier: MIT
#include "protocol/program/file_catcher.h"

#include <fcntl.h>
#include <poll.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <filesystem>

#include "protocol/wire/errors.h"
#include "protocol/wire/text.h"

namespace protocol {

FileCatcher::FileCatcher(const std::string& ending)
    : path_(format("{}/bplbm-{}{}", std::filesystem::temp_directory_path().string(), getpid(),
                   ending)) {
  unlink(path_.c_str());  // of a program of that number that was killed
  // Opened without waiting for a writer, and before there is one, so that nobody ever waits.
  if (mkfifo(path_.c_str(), 0600) != 0 ||
      (pipe_ = open(path_.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC)) < 0)
    throw ProgramError(format("{} cannot be made: {}; set TMPDIR to a folder that is writable",
                              path_, std::strerror(errno)));
  reader_ = std::thread([this] { read_until_done(); });
}

FileCatcher::~FileCatcher() {
  take();
  close(pipe_);
  unlink(path_.c_str());
}

Bytes FileCatcher::take() {
  done_ = true;
  if (reader_.joinable()) reader_.join();
  return std::move(bytes_);
}

void FileCatcher::read_until_done() {
  constexpr int kMilliseconds = 1;
  std::array<std::byte, 1 << 16> piece;
  for (;;) {
    const bool last = done_;  // what was written before is in the pipe by now
    pollfd waiting{pipe_, POLLIN, 0};
    poll(&waiting, 1, last ? 0 : kMilliseconds);
    const auto size = read(pipe_, piece.data(), piece.size());
    if (size > 0)
      bytes_.insert(bytes_.end(), piece.begin(), piece.begin() + size);
    else if (last)
      return;
  }
}

}  // namespace protocol
