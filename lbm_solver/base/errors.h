// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <stdexcept>
#include <string>

#include "protocol/wire/errors.h"

namespace lbm {

/// A scene or command line that cannot work. Grammar: <where>: <problem>; <what to do>.
class InputError : public protocol::ProtocolError {
 public:
  InputError(const std::string& problem, const std::string& remedy)
      : ProtocolError(problem + "; " + remedy, protocol::kBadInput) {}
  InputError(const std::string& where, const std::string& problem, const std::string& remedy)
      : ProtocolError(where + ": " + problem + "; " + remedy, protocol::kBadInput) {}
};

/// The computation left the range in which it means something.
class NumericsError : public protocol::ProtocolError {
 public:
  explicit NumericsError(const std::string& what) : ProtocolError(what, protocol::kNumerics) {}
};

}  // namespace lbm
