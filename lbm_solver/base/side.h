// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

namespace lbm {

/// A side of the box.
enum class SideName { Left, Right, Bottom, Top };

}  // namespace lbm
