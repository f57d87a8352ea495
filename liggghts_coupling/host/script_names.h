// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace dem {

/// Value of a script variable, or nothing where there is none of that name.
using VariableValue = std::function<std::optional<std::string>(const std::string& name)>;

/// Names that a script, or what it includes, takes as ${name} and that nothing defines: neither
/// `value` nor a `variable` command anywhere in it. Each once, as "${name} (FILE:LINE)", in the
/// order of the lines. LIGGGHTS says "illegal variable" and not which.
std::vector<std::string> undefined_names(const std::string& script, const VariableValue& value);

}  // namespace dem
