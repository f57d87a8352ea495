// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <string>
#include <vector>

namespace lbm {

/// Every key of a scene with its type, unit, default, range and one sentence, as rows of a Markdown
/// table: what `lbm --keys` prints, and what lbm_solver/docs/scene.md holds. All but the sentences
/// comes from the reader.
std::string describe_keys();

/// Keys of the reader without a sentence, and sentences without a key: each a complaint that names
/// it and says what to do. Empty where all is well, as a test holds.
std::vector<std::string> complaints_about_keys();

}  // namespace lbm
