// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <string>

namespace lbm {

/// Whether a script variable of this name is the program's own: what `lbm check --liggghts-vars`
/// prints of itself (coupling/hello), and what `liggghts` adds, such as the folder that the script
/// includes files from. A scene that could replace one could have a foreign file executed.
bool is_reserved_variable(const std::string& name);

/// Why a name and its value cannot become `-var NAME VALUE`; empty where they can.
std::string why_no_variable(const std::string& name, const std::string& value);

}  // namespace lbm
