// SPDX-License-Identifier: GPL-2.0-or-later
/// Contracts between parts of the program; vanish in release builds. Input is never checked with
/// these, but with InputError.
#pragma once

#include <cstdio>
#include <cstdlib>

#if defined(NDEBUG)
#define BPLBM_EXPECT(condition) static_cast<void>(0)
#else
#define BPLBM_EXPECT(condition)                                                                 \
  ((condition) ? static_cast<void>(0)                                                           \
               : (std::fprintf(stderr, "%s:%d: expected %s\n", __FILE__, __LINE__, #condition), \
                  std::abort()))
#endif
