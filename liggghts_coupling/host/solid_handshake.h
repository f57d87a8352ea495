// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <pointers.h>

#include "liggghts_coupling/host/script_clumps.h"
#include "protocol/wire/messages.h"

namespace dem {

/// Reads from a set-up LIGGGHTS what the fluid must agree on.
class SolidHandshake : protected LAMMPS_NS::Pointers {
 public:
  SolidHandshake(LAMMPS_NS::LAMMPS* lammps, int groupbit, int substeps, const ScriptClumps& clumps);

  /// Collective over the DEM ranks. Fails with LIGGGHTS' own error where the set-up cannot couple.
  protocol::Hello collect();
  /// Warns where no fix moves the particles.
  void expect_motion() const;

 private:
  void geometry(protocol::Hello& hello) const;
  void forces(protocol::Hello& hello) const;
  void particles(protocol::Hello& hello) const;
  int groupbit_, substeps_;
  const ScriptClumps& clumps_;
};

/// Volume of a particle: a sphere, or in 2D a disc of the given depth.
double particle_volume(int dimension, double radius, double depth);

}  // namespace dem
