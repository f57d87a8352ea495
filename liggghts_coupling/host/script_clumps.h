// SPDX-License-Identifier: GPL-2.0-or-later
/// The clumps of a script: rigid bodies of spheres that overlap, which `fix multisphere` and
/// `fix rigid` move.
#pragma once

#include <fix_multisphere.h>
#include <fix_rigid.h>
#include <pointers.h>

#include <cstdint>
#include <span>
#include <vector>

#include "protocol/solid/clump_coupling.h"

namespace dem {

/// Of `fix multisphere` each body is a clump, on the rank that owns it. Of a `fix rigid` whose
/// spheres overlap each body is one, on the first rank (every rank knows all of them); where they
/// do not overlap, spheres couple as grains, and the fix adds up what comes for them. Loads are
/// added to the bodies themselves, not to their spheres.
class ScriptClumps : protected LAMMPS_NS::Pointers {
 public:
  explicit ScriptClumps(LAMMPS_NS::LAMMPS* lammps) : Pointers(lammps) {}

  /// Looks for the fixes; at the beginning of a run. Collective.
  void find();
  bool any() const { return multisphere_ || !rigid_.empty(); }
  const LAMMPS_NS::FixMultisphere* multisphere() const { return multisphere_; }
  bool has_rigid() const { return !rigid_.empty(); }

  /// The clump of a sphere whose clump is no more: another sphere of it has left the box, and
  /// LIGGGHTS takes this one out when it looks for neighbours next.
  static constexpr std::int64_t kGone = protocol::kItself - (std::int64_t{1} << 31) - 1;
  /// Of each local particle the clump that it belongs to; null where there are no clumps.
  const std::int64_t* carriers() const;
  /// Some of their spheres are in a group, some are not. Collective.
  bool in_part(int groupbit) const;
  /// A body of fix rigid that has its mass from a file, while fix gravity weighs its spheres.
  /// Collective. @throws protocol::ProgramError  exit code 2: the two differ
  void refuse_wrong_weight() const;
  /// Those that this rank answers for.
  std::vector<protocol::EngineClump> clumps() const;
  /// Adds loads of all ranks' clumps.
  void push(std::span<const protocol::Load> loads, protocol::Moment when);

 private:
  void add_multisphere(std::vector<protocol::EngineClump>& clumps) const;
  void expect_weight_of(std::size_t number) const;
  void add_rigid(std::size_t number, std::vector<protocol::EngineClump>& clumps) const;
  void push_rigid(std::size_t number, std::span<const protocol::Load> loads, bool to_bodies);

  LAMMPS_NS::FixMultisphere* multisphere_ = nullptr;
  std::vector<LAMMPS_NS::FixRigid*> rigid_;
  std::vector<bool> set_up_before_;  // of each fix rigid: it stands before fix lbm/couple
  mutable std::vector<std::int64_t> carriers_;  // of the last call
};

}  // namespace dem
