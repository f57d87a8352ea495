// SPDX-License-Identifier: GPL-2.0-or-later
/// What the pair style and the fixes about bonds share in one process: a wish to make bonds, and
/// what happened to them.
#pragma once

#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "liggghts_coupling/bond/bond_law.h"

namespace dem {

/// Which pairs are to be bonded in the coming force computation.
struct BondRequest {
  std::string fix;                           ///< that asks for it
  bool open = true;                          ///< until a force computation has answered it
  double gap = 0.0;                          ///< largest gap [m]
  std::optional<std::pair<int, int>> types;  ///< only between these two
  std::optional<std::set<std::pair<long, long>>>
      listed;  ///< only these pairs of ids, smaller first

  bool wants(long a, long b, int type_a, int type_b, double overlap) const {
    if (-overlap > gap) return false;
    if (types && *types != std::pair(type_a, type_b) && *types != std::pair(type_b, type_a))
      return false;
    return !listed || listed->contains({std::min(a, b), std::max(a, b)});
  }

  long made = 0;   ///< bonds, of this process
  long found = 0;  ///< pairs that it wants, also those that an earlier one has bonded
};

/// A bond that broke.
struct BreakEvent {
  long step = 0;
  double time = 0.0;           ///< [s]; in a coupled run the fluid's
  long first = 0, second = 0;  ///< ids, the smaller first
  Break mode = Break::None;
  double force = 0.0;  ///< that broke it [N]
  Vector place{};      ///< contact point [m]
  Vector normal{};     ///< unit, from the second to the first
};

/// What became of bonds since the beginning of the run. Of this process; a pair that two processes
/// compute is counted by one. Kept in restart files.
struct BondTally {
  long created = 0;
  long tension = 0, shear = 0;  ///< broken
  long left = 0;                ///< with a particle that left the box
  long lost = 0;                ///< with a particle that was taken out

  long gone() const { return tension + shear + left + lost; }
};

/// Of this process; a pair that two processes compute is counted by one.
struct BondBook {
  static BondBook& instance();

  std::vector<BondRequest> requests;  ///< the first that wants a pair makes its bond
  BondRequest* request_of(const std::string& fix);
  bool has_spread = false;  ///< some fix has set it
  double spread = 0.0;      ///< of the strengths
  unsigned long seed = 0;
  double largest_gap = 0.0;  ///< of any bond made, for the guard [m]

  BondTally tally;
  long intact = 0;                 ///< at the last force computation
  int column = 0;                  ///< "bonded" in a pair's history
  long first_step = 0;             ///< at which time is 0: in a coupled run the fluid's
  EnergyFlow energy;               ///< elastic now, the rest since the beginning [J]
  std::vector<BreakEvent> events;  ///< not yet written
  long written_until = -1;         ///< step; those up to it are written; -1: nobody says so
  bool list_wanted = false;        ///< the coming force computations list the intact bonds
  std::vector<std::pair<long, long>>
      listed;                      ///< intact at the last force computation, where wanted
  std::vector<BreakEvent> broken;  ///< all since the beginning of the run
};

}  // namespace dem
