// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <stdexcept>
#include <string>

#include "protocol/wire/errors.h"

namespace lbm {

/// A scene or command line that cannot work. Grammar: <where>: <problem>; <what to do>.
class InputError : public protocol::ProgramError {
 public:
  InputError(const std::string& problem, const std::string& remedy)
      : ProgramError(problem + "; " + remedy, protocol::kBadInput) {}
  InputError(const std::string& where, const std::string& problem, const std::string& remedy)
      : ProgramError(where + ": " + problem + "; " + remedy, protocol::kBadInput) {}
};

/// The computation left the range in which it means something.
class NumericsError : public protocol::ProgramError {
 public:
  explicit NumericsError(const std::string& what) : ProgramError(what, protocol::kNumerics) {}
};

}  // namespace lbm
