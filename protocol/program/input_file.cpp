// SPDX-License-Identifier: MIT
#include "protocol/program/input_file.h"

#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>

#include "protocol/wire/text.h"

namespace protocol {

namespace fs = std::filesystem;

std::string why_unreadable(const std::string& path, std::uintmax_t most) {
  std::error_code error;
  const fs::file_status status = fs::status(path, error);
  if (status.type() == fs::file_type::not_found) return "no such file";
  if (status.type() == fs::file_type::directory) return "is a folder, not a file";
  if (status.type() != fs::file_type::regular)
    return error ? error.message() : "is no regular file (a pipe or a device?)";
  if (access(path.c_str(), R_OK) != 0) return std::strerror(errno);
  const std::uintmax_t size = fs::file_size(path, error);
  if (error) return error.message();
  if (size <= most) return {};
  return format("holds {:.3g} MB, more than the {:.3g} MB that such a file may have",
                1e-6 * static_cast<double>(size), 1e-6 * static_cast<double>(most));
}

}  // namespace protocol
