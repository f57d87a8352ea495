// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

namespace LAMMPS_NS {
class LAMMPS;
}

namespace dem {

/// Makes our styles known to a LIGGGHTS instance, before its script is read.
void register_styles(LAMMPS_NS::LAMMPS& lammps);

}  // namespace dem
