// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <string>
#include <vector>

#include "lbm_solver/base/scene.h"

namespace lbm {

/// Reads a scene file and lays overlays over it, key by key, in order.
/// @param files  the scene, then its overlays
/// @throws InputError with file and line: not found, no TOML, unknown or missing key, wrong type,
///         value outside its range
Scene read_scene(const std::vector<std::string>& files);

/// coupling.connect_timeout of a scene [s], before anything else of it is read; its default where
/// the files do not say or cannot be read.
double connect_timeout_in(const std::vector<std::string>& files);

class KeyNotes;
/// Notes the keys that are asked for while this scene, a text, is read.
void note_keys(const std::string& scene, KeyNotes& keys);

}  // namespace lbm
