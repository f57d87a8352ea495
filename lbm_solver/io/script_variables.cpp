// SPDX-License-Identifier: GPL-2.0-or-later
#include "lbm_solver/io/script_variables.h"

#include <fmt/core.h>

#include <cctype>
#include <regex>

namespace lbm {

namespace {

bool is_plain(unsigned char c) {
  return c == '_' || (c < 128 && std::isalnum(c));
}

/// The first character that is no letter, digit, `_` or one of `others`, as it can be shown; empty
/// where there is none.
std::string first_not_of(const std::string& text, const std::string& others) {
  for (const char c : text) {
    if (is_plain(static_cast<unsigned char>(c)) || others.find(c) != std::string::npos) continue;
    if (c == ' ') return "a blank";
    return c > ' ' && c < 127 ? fmt::format("'{}'", c)
                              : fmt::format("the byte {:#04x}", static_cast<unsigned char>(c));
  }
  return {};
}

}  // namespace

bool is_reserved_variable(const std::string& name) {
  static const std::regex ours(
      "[xyz]_(lo|hi)|(boundary|walls)_[xyz]|dimension|depth|gravity(_[xyz])?|solid_step|substeps|"
      "solid_steps_total|coupling_timeout|restart|restart_file|checkpoint|(diameter|density)_(min|"
      "max)|"
      "particle[0-9]+_[xyz]|mesh[0-9]+(_motion)?|disc[0-9]+_wall|contact_stiffness|scene_folder|"
      "out_folder");
  return std::regex_match(name, ours);
}

std::string why_no_variable(const std::string& name, const std::string& value) {
  if (name.empty() || !first_not_of(name, "").empty()) return "is no name that a script can use";
  if (value.empty()) return "is empty";
  // LIGGGHTS would take it for its next option
  if (value.size() > 1 && value[0] == '-' && !std::isdigit(static_cast<unsigned char>(value[1])) &&
      value[1] != '.')
    return "begins with '-', as an option of LIGGGHTS does";
  if (const std::string odd = first_not_of(value, ".,:/+-*="); !odd.empty())
    return "holds " + odd + ", which a script could read as more than one word";
  if (value[0] == '/' || std::regex_search(value, std::regex(R"((^|/)\.\.(/|$))")))
    return "leads out of the scene's folder, from where a script could include a foreign file";
  return {};
}

std::string why_no_script_path(const std::string& path) {
  const auto at = path.find_first_of("\"'$&#`\n\r");
  if (at == std::string::npos) return {};
  return fmt::format("holds {}, which a LIGGGHTS script cannot have in the name of a file",
                     first_not_of(path.substr(at, 1), ""));
}

}  // namespace lbm
