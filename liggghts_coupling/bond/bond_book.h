// SPDX-License-Identifier: GPL-2.0-or-later
/// What the pair style and the fixes about bonds share in one process: a wish to make bonds, and
/// what happened to them.
#pragma once

#include <algorithm>
#include <array>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "liggghts_coupling/bond/bond_law.h"

namespace LAMMPS_NS {
class LAMMPS;
}

namespace dem {

/// A straight cut in the xy plane; in three dimensions the plane above it along z.
struct Notch {
  std::array<double, 2> from{}, to{};  ///< its ends [m]

  /// Whether the line between two centres crosses the cut; touching its end is crossing.
  bool separates(const double* a, const double* b) const {
    const auto side = [](const auto& p, const auto& q, const auto& x) {
      return (q[0] - p[0]) * (x[1] - p[1]) - (q[1] - p[1]) * (x[0] - p[0]);
    };
    return side(from, to, a) * side(from, to, b) <= 0.0 && side(a, b, from) * side(a, b, to) <= 0.0;
  }
};

/// Two particles that may be bonded.
struct BondCandidate {
  std::array<long, 2> ids{};
  std::array<int, 2> types{};
  std::array<const double*, 2> centres{};  ///< [m][3]
  double overlap = 0.0;                    ///< negative in a gap [m]
};

/// Which pairs are to be bonded in the coming force computation.
struct BondRequest {
  std::string fix;                           ///< that asks for it
  bool open = true;                          ///< until a force computation has answered it
  double gap = 0.0;                          ///< largest gap [m]
  std::optional<std::pair<int, int>> types;  ///< only between these two
  std::optional<std::set<std::pair<long, long>>>
      listed;                    ///< only these pairs of ids, smaller first
  std::vector<Notch> notches{};  ///< no bond across these

  bool wants(const BondCandidate& pair) const {
    if (-pair.overlap > gap) return false;
    const auto [a, b] = pair.types;
    if (types && *types != std::pair(a, b) && *types != std::pair(b, a)) return false;
    if (listed && !listed->contains(std::minmax(pair.ids[0], pair.ids[1]))) return false;
    return std::none_of(notches.begin(), notches.end(), [&pair](const Notch& notch) {
      return notch.separates(pair.centres[0], pair.centres[1]);
    });
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
  /// That of one LIGGGHTS. The pair style and the fixes own it together: it is made for the first
  /// of them, and goes with the last.
  static std::shared_ptr<BondBook> of(const LAMMPS_NS::LAMMPS* lammps);

  std::vector<BondRequest> requests;  ///< the first that wants a pair makes its bond
  BondRequest* request_of(const std::string& fix);
  bool has_spread = false;  ///< some fix has set it
  double spread = 0.0;      ///< of the strengths
  unsigned long seed = 0;
  double largest_gap = 0.0;   ///< without force, of any bond made, for the guard [m]
  double reserved_gap = 0.0;  ///< for which pairs keep their history in this run [m]

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
