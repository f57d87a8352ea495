// SPDX-License-Identifier: MIT
#pragma once

#include <CLI/CLI.hpp>
#include <optional>
#include <string>

#include "protocol/wire/errors.h"
#include "protocol/wire/numbers.h"

namespace protocol {

/// A finite number, above or, if it may be equal, of at least `low`. (CLI::PositiveNumber and
/// CLI::Range let nan through.)
inline CLI::Validator finite_number(double low, bool may_be_equal = false) {
  const std::string wanted =
      (may_be_equal ? "a number of at least " : "a number above ") + CLI::detail::to_string(low);
  return {[=](std::string& text) -> std::string {
            const auto value = to_number<double>(text);
            if (value && (*value > low || (may_be_equal && *value == low))) return {};
            return "'" + text + "' is not " + wanted;
          },
          wanted};
}

/// Reads the command line into what `app` was told of.
/// @param program  named in the message of a mistake: "PROGRAM | error | …"
/// @return  the exit code to end with (kOk after --help, kBadInput after a mistake), or nothing:
///          go on
inline std::optional<int> read_command_line(CLI::App& app, const std::string& program, int argc,
                                            char** argv) {
  app.failure_message([&program](const CLI::App* /*app*/, const CLI::Error& error) {
    return program + " | error | " + error.what() + "; " + program +
           " --help shows what there is\n";
  });
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? kOk : kBadInput;
  }
  return std::nullopt;
}

}  // namespace protocol
