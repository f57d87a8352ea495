// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <functional>
#include <optional>
#include <string>

namespace dem {

/// The words of `fix ID group lbm/couple every N [timeout S] [record FILE]`.
struct CoupleArguments {
  int substeps = 0;               ///< solid steps a coupling interval
  std::optional<double> timeout;  ///< [s]; else the fluid's
  std::string record;             ///< trace file
};

/// @param fail  called with what is wrong; does not return
CoupleArguments read_arguments(int narg, char** arg,
                               const std::function<void(const std::string&)>& fail);

}  // namespace dem
