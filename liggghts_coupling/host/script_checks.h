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

  /// Particles that are no rigid bodies of spheres.
  void refuse_other_shapes() const;

  /// Some spheres of a group overlap, on this rank.
  bool joins_overlapping(int groupbit) const;

  /// Particles of a group with the centre of one in the other, on this rank, but spheres of one
  /// clump. LIGGGHTS itself takes minutes to find the neighbours of some thousand at one place.
  /// @param carriers  of each particle its clump; may be null
  void refuse_overlaps(int groupbit, const std::int64_t* carriers) const;

  /// The time step is another one. @param step  agreed [s]
  [[noreturn]] void refuse_step(double step) const;

  /// @param box  agreed
  void expect_box(const protocol::Hello& box) const;

 private:
  std::string fix_of_style(const std::string& style) const;
  std::vector<protocol::Ball> balls(int groupbit, const std::int64_t* carriers = nullptr) const;
  protocol::Hello box() const;
};

}  // namespace dem
