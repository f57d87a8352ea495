// SPDX-License-Identifier: GPL-2.0-or-later
#include "lbm_solver/io/script_variables.h"

#include <algorithm>
#include <cctype>
#include <regex>

namespace lbm {

bool is_reserved_variable(const std::string& name) {
  static const std::regex ours(
      "[xyz]_(lo|hi)|(boundary|walls)_[xyz]|dimension|depth|gravity(_[xyz])?|solid_step|substeps|"
      "solid_steps_total|coupling_timeout|restart|restart_file|checkpoint|(diameter|density)_(min|"
      "max)|"
      "particle[0-9]+_[xyz]|mesh[0-9]+|contact_stiffness|scene_folder|out_folder");
  return std::regex_match(name, ours);
}

std::string why_no_variable(const std::string& name, const std::string& value) {
  const auto plain = [](unsigned char c) { return c == '_' || (c < 128 && std::isalnum(c)); };
  if (name.empty() || !std::all_of(name.begin(), name.end(), plain))
    return "is no name that a script can use";
  if (value.empty()) return "is empty";
  // LIGGGHTS would take it for its next option
  if (value.size() > 1 && value[0] == '-' && !std::isdigit(static_cast<unsigned char>(value[1])) &&
      value[1] != '.')
    return "begins with '-', as an option of LIGGGHTS does";
  if (value.find_first_of("\n\r") != std::string::npos) return "holds more than one line";
  return {};
}

}  // namespace lbm
