// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <lammps.h>
// clang-format off
#include <atom.h>
#include <fix_property_global.h>
#include <modify.h>
// clang-format on

namespace dem {

/// Values [type][type], counted from 0, of a script's `property/global NAME peratomtypepair`; null
/// where it has none. @param asker  a style, for LIGGGHTS
inline const double* const* pair_property(const LAMMPS_NS::LAMMPS& lammps, const char* name,
                                          const char* asker) {
  auto* fix = dynamic_cast<LAMMPS_NS::FixPropertyGlobal*>(lammps.modify->find_fix_property(
      name, "property/global", "peratomtypepair", lammps.atom->ntypes, 0, asker, false));
  return fix ? fix->get_array() : nullptr;
}

}  // namespace dem
