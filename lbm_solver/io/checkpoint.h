// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <map>
#include <string>
#include <vector>

namespace lbm {

/// Everything that a run needs to go on as if it had never stopped: named arrays, every bit kept.
using State = std::map<std::string, std::vector<double>>;

/// Writes a state to `path`, whole or not at all: a kill meanwhile leaves the checkpoint before.
void write_checkpoint(const std::string& path, const State& state);

/// @throws InputError where the file is missing or no checkpoint
State read_checkpoint(const std::string& path);

/// One array of a checkpoint. @throws InputError where there is no checkpoint
std::vector<double> read_checkpoint_array(const std::string& path, const std::string& name);

}  // namespace lbm
