// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <stdexcept>
#include <string>

namespace lbm {

/// A file of a scene is not what it should be; whoever reads the key that names it adds the rest.
[[noreturn]] inline void refuse(const std::string& problem, const std::string& remedy) {
  throw std::invalid_argument(problem + "; " + remedy);
}

}  // namespace lbm
