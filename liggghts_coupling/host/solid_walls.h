// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <lammps.h>

#include "protocol/wire/messages.h"

namespace dem {

/// Says in `hello`, whose box is known, which sides of the box have a plane wall of the script, and
/// which other walls there are: meshes, cylinders, planes inside, regions; of meshes and cylinders
/// whether they move.
void tell_walls(LAMMPS_NS::LAMMPS& lammps, protocol::Hello& hello);

}  // namespace dem
