// SPDX-License-Identifier: MIT
#include "protocol/solid_parts.h"

#include <fmt/format.h>

#include <filesystem>
#include <fstream>

#include "protocol/errors.h"

namespace protocol {

namespace fs = std::filesystem;

namespace {

std::string plain(const std::string& path) {
  return fs::absolute(path).lexically_normal();
}

}  // namespace

SolidParts::SolidParts(const std::string& prefix, const std::string& last)
    : prefix_(plain(prefix)), last_(last.empty() ? last : plain(last)) {}

SolidParts SolidParts::of(const Hello& fluid) {
  std::string prefix = "checkpoint", last;
  for (const Variable& v : fluid.variables) {
    if (v.name == "checkpoint") prefix = v.value;
    if (v.name == "restart_file" && fluid.first_interval > 0) last = v.value;
  }
  return SolidParts(prefix, last);
}

SolidParts SolidParts::beside(const std::string& name) const {
  return SolidParts(fs::path(prefix_).parent_path() / name);
}

std::string SolidParts::name(std::int64_t interval) const {
  return fmt::format("{}.{}.solid", prefix_, interval);
}

void SolidParts::keep(std::int64_t interval, std::span<const std::byte> content) {
  const std::string whole = name(interval), part = whole + ".part";
  std::ofstream out(part, std::ios::binary);
  out.write(reinterpret_cast<const char*>(content.data()), std::ssize(content));
  out.close();
  std::error_code error;
  if (out) fs::rename(part, whole, error);
  if (!out || error) {
    fs::remove(part, error);
    throw ProtocolError("the checkpoint " + whole + " cannot be written; is the disk full?");
  }
  for (const auto& entry : fs::directory_iterator(fs::path(prefix_).parent_path())) {
    const std::string found = entry.path().string();
    if (found.starts_with(prefix_ + ".") && found.ends_with(".solid") && found != whole &&
        found != last_)
      fs::remove(entry.path(), error);
  }
  last_ = whole;
}

}  // namespace protocol
