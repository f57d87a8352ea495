// SPDX-License-Identifier: GPL-2.0-or-later
/// What a script may not do in a coupled run, found where it is known which of its fixes does it.
#pragma once

#include <pointers.h>

#include <string>
#include <vector>

#include "protocol/wire/overlap.h"

namespace dem {

/// @throws protocol::ProgramError  exit code 2: what is wrong, which fix, what to do
class ScriptChecks : protected LAMMPS_NS::Pointers {
 public:
  explicit ScriptChecks(LAMMPS_NS::LAMMPS* lammps) : Pointers(lammps) {}

  /// Particles that are more than one sphere, or none: the fluid knows spheres only.
  void refuse_clumps() const;

  /// Particles of a group with the centre of one in the other, on this rank. LIGGGHTS itself takes
  /// minutes to find the neighbours of some thousand at one place.
  void refuse_overlaps(int groupbit) const;

  /// The time step is another one. @param step  agreed [s]
  [[noreturn]] void refuse_step(double step) const;

  /// @param box  agreed
  void expect_box(const protocol::Hello& box) const;

 private:
  std::string fix_of_style(const std::string& style) const;
  std::vector<protocol::Ball> balls(int groupbit) const;
  protocol::Hello box() const;
};

}  // namespace dem
