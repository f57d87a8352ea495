// SPDX-License-Identifier: MIT
/// What the benchmarks without options say when they are asked how they are called.
#pragma once

#include <cstdio>
#include <string_view>

namespace bench {

/// Whether `--help` is among the arguments; `usage` is printed then.
inline bool asks_for_help(int argc, char** argv, const char* usage) {
  for (int i = 1; i < argc; ++i)
    if (std::string_view(argv[i]) == "--help") return std::printf("%s\n", usage) > 0;
  return false;
}

}  // namespace bench
