// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <lammps.h>
// clang-format off
#include <atom.h>
#include <domain.h>
// clang-format on

#include <vector>

namespace dem {

/// Which particles of this process, of a group, the coming exchange between processes takes out:
/// those beyond a side of the box that is not periodic, by LIGGGHTS' own comparison. To be asked
/// before the exchange, where a fix has its pre_exchange().
inline std::vector<int> leaving(const LAMMPS_NS::LAMMPS& lammps, int groupbit) {
  const LAMMPS_NS::Atom& atom = *lammps.atom;
  const LAMMPS_NS::Domain& box = *lammps.domain;
  std::vector<int> found;
  for (int i = 0; i < atom.nlocal; ++i) {
    if (!(atom.mask[i] & groupbit)) continue;
    for (int k = 0; k < 3; ++k) {
      const double x = atom.x[i][k];
      if (box.periodicity[k] || (x >= box.boxlo[k] && x < box.boxhi[k])) continue;
      found.push_back(i);
      break;
    }
  }
  return found;
}

}  // namespace dem
