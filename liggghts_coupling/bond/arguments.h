// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <error.h>
#include <fix.h>

#include <string>

#include "protocol/wire/numbers.h"

namespace dem {

/// The value of a fix's word as a number. (LIGGGHTS' own reading takes "1.2.3" for 1.2.)
template <class Number>
Number argument(LAMMPS_NS::Error* error, LAMMPS_NS::Fix* fix, const std::string& word,
                const char* value) {
  const auto number = protocol::to_number<Number>(value);
  if (!number)
    error->fix_error(FLERR, fix,
                     ("'" + word + " " + value + "': give a " +
                      (std::is_integral_v<Number> ? "whole number" : "number"))
                         .c_str());
  return number.value_or(Number{});
}

}  // namespace dem
