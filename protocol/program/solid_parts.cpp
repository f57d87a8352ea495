// SPDX-License-Identifier: MIT
#include "protocol/program/solid_parts.h"

#include <filesystem>
#include <fstream>
#include <set>

#include "protocol/wire/errors.h"
#include "protocol/wire/numbers.h"
#include "protocol/wire/text.h"

namespace protocol {

namespace fs = std::filesystem;

namespace {

constexpr std::size_t kEarlier = 2;  // parts that stay beside the last one

std::string plain(const std::string& path) {
  return fs::absolute(path).lexically_normal();
}

}  // namespace

SolidParts::SolidParts(const std::string& prefix) : prefix_(plain(prefix)) {}

SolidParts SolidParts::of(const Hello& fluid) {
  for (const Variable& v : fluid.variables)
    if (v.name == "checkpoint") return SolidParts(v.value);
  return SolidParts("checkpoint");
}

SolidParts SolidParts::beside(const std::string& name) const {
  return SolidParts(fs::path(prefix_).parent_path() / name);
}

std::string SolidParts::name(std::int64_t interval) const {
  return format("{}.{}.solid", prefix_, interval);
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
    throw ProgramError("the checkpoint " + whole + " cannot be written; is the disk full?");
  }
  remove_others(interval);
}

void SolidParts::remove_others(std::int64_t interval) const {
  std::set<std::int64_t> earlier;
  std::error_code none;
  for (const auto& entry : fs::directory_iterator(fs::path(prefix_).parent_path())) {
    const std::string found = entry.path().string();
    if (!found.starts_with(prefix_ + ".")) continue;
    const auto number = to_number<std::int64_t>(
        found.substr(prefix_.size() + 1, found.find('.', prefix_.size() + 1) - prefix_.size() - 1));
    if (!number || found != name(*number)) continue;
    if (*number < interval) earlier.insert(*number);
    if (*number > interval) fs::remove(entry.path(), none);
  }
  for (; earlier.size() > kEarlier; earlier.erase(earlier.begin()))
    fs::remove(name(*earlier.begin()), none);
}

}  // namespace protocol
