// SPDX-License-Identifier: GPL-2.0-or-later
/// Include before LAMMPS' headers: they name a function of an older fmt than Debian ships. Only the
/// name is wanted; we call none of the templates that use it.
#pragma once

#include <fmt/format.h>

namespace fmt {
template <class... Args, class Format>
auto make_args_checked(const Format&, const std::remove_reference_t<Args>&... args) {
  return make_format_args(args...);
}
}  // namespace fmt
