// SPDX-License-Identifier: MIT
/// What the judge looks at, one after the other: a row for each.
#pragma once

#include <span>
#include <string>

#include "tools/engines/conformance/judge.h"

namespace conformance {

/// A check that is passed, and leaves by ending the job.
struct Aborts {
  int exit_code;
};

struct Check {
  std::string name;
  std::string must;  ///< what an engine must do
  int exit_code;     ///< of the job
  int fluid_ranks;   ///< at least
  void (*run)(Judge&);
  bool optional = false;  ///< made only where it is named
};

std::span<const Check> checks();
/// @return  null where there is none of that name
const Check* find(const std::string& name);

}  // namespace conformance
