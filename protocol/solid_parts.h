// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

#include "protocol/messages.h"

namespace protocol {

/// The solid's files of checkpoints: `<prefix>.<interval>.solid`, each whole or not at all. The
/// fluid knows them by that name.
class SolidParts {
 public:
  /// @param prefix  with folder; made absolute, since a script may change its folder
  /// @param last    file that the fluid may still need; empty: none
  explicit SolidParts(const std::string& prefix, const std::string& last = {});
  /// As a fluid wants them: the variables `checkpoint` and, after a restart, `restart_file`.
  static SolidParts of(const Hello& fluid);
  /// Of the same folder, under another name.
  SolidParts beside(const std::string& name) const;

  std::string name(std::int64_t interval) const;
  /// Writes the part of an interval. It and the one before stay, older ones are removed.
  /// @throws ProtocolError  cannot be written; those before stay
  void keep(std::int64_t interval, std::span<const std::byte> content);

 private:
  std::string prefix_, last_;
};

}  // namespace protocol
