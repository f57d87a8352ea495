// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

#include "protocol/wire/messages.h"

namespace protocol {

/// The solid's files of checkpoints: `<prefix>.<interval>.solid`, each whole or not at all. The
/// fluid knows them by that name, and keeps the length and checksum of each.
class SolidParts {
 public:
  /// @param prefix  with folder; made absolute, since a script may change its folder
  explicit SolidParts(const std::string& prefix);
  /// As a fluid wants them: the variable `checkpoint`.
  static SolidParts of(const Hello& fluid);
  /// Of the same folder, under another name.
  SolidParts beside(const std::string& name) const;

  std::string name(std::int64_t interval) const;
  /// Writes the part of an interval. It and the two before stay: until the fluid has written its
  /// own, the last whole pair is the one before, and the one before that stands behind it. Older
  /// ones are removed, and those of later intervals, from which no run will go on.
  /// @throws ProgramError  cannot be written; those before stay
  void keep(std::int64_t interval, std::span<const std::byte> content);

 private:
  void remove_others(std::int64_t interval) const;

  std::string prefix_;
};

}  // namespace protocol
