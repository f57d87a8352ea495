// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <string>

namespace lbm {

/// Whether a script variable of this name is the program's own: what `lbm check --liggghts-vars`
/// prints of itself (coupling/handshake), and what `liggghts` adds, such as the folder that the
/// script includes files from. A scene that could replace one could have a foreign file executed.
bool is_reserved_variable(const std::string& name);

/// Why a name and its value cannot become `-var NAME VALUE`; empty where they can. LIGGGHTS puts a
/// value into a line as text before it looks for words, quotes and commands: a value is one word of
/// letters, digits and `_ . , : / + - * =`, and no path out of the scene's folder.
std::string why_no_variable(const std::string& name, const std::string& value);

/// Why the path of a folder that the user has chosen cannot stand in a script; empty where it can.
/// One with blanks can, between quotes.
std::string why_no_script_path(const std::string& path);

}  // namespace lbm
