// SPDX-License-Identifier: MIT
#pragma once

#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "protocol/wire/messages.h"

namespace protocol {

/// Exit codes of every program of this project.
enum ExitCode : int { kOk = 0, kFault = 1, kBadInput = 2, kNumerics = 3, kOutOfTolerance = 4 };

/// What ends a program of a job: carries the exit code that it leads to. Its kinds are mistakes of
/// a user (a scene, a script, a command line), what the machine refuses (a full disk), a
/// computation that cannot go on, and errors of the exchange.
class ProgramError : public std::runtime_error {
 public:
  explicit ProgramError(const std::string& what, int exit_code = kFault)
      : std::runtime_error(what), exit_code_(exit_code) {}
  int exit_code() const { return exit_code_; }

 private:
  int exit_code_;
};

/// Something is wrong with the exchange itself.
class ProtocolError : public ProgramError {
 public:
  using ProgramError::ProgramError;
};

/// Nothing came in time. The text names whom was waited for, for what, and for how long.
class Timeout : public ProtocolError {
 public:
  using ProtocolError::ProtocolError;
};

/// A frame that cannot be what it claims to be.
class BadMessage : public ProtocolError {
 public:
  using ProtocolError::ProtocolError;
};

/// The partner reported that it cannot go on.
class PeerFault : public ProtocolError {
 public:
  explicit PeerFault(const Fault& fault) : ProtocolError(fault.reason, fault.exit_code) {}
};

/// The partner said goodbye where the job cannot do without it.
class PeerLeft : public ProtocolError {
 public:
  using ProtocolError::ProtocolError;
};

/// The two handshakes contradict each other.
class Refusal : public ProtocolError {
 public:
  explicit Refusal(std::vector<std::string> reasons)
      : ProtocolError(join(reasons), kBadInput), reasons_(std::move(reasons)) {}
  const std::vector<std::string>& reasons() const { return reasons_; }

 private:
  static std::string join(const std::vector<std::string>& reasons) {
    std::string text = "fluid and solid disagree:";
    for (const auto& r : reasons) text += "\n  - " + r;
    return text;
  }
  std::vector<std::string> reasons_;
};

}  // namespace protocol
