// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <mpi.h>
// clang-format off
#include <lammps.h>
#include <fix.h>
// clang-format on

#include <array>
#include <map>
#include <set>
#include <span>
#include <string>
#include <utility>

#include "liggghts_coupling/bond/bond_book.h"

namespace dem {

/// fix ID all bond/create gap G [types A B] [list FILE] [notch X1 Y1 X2 Y2] [spread S seed N]
///
/// Bonds, once, at the beginning of the next run, every pair of particles whose gap is at most G
/// [m]: of all types or of two, or only the pairs of ids in a file (two a line); none across a
/// notch, a straight cut between two points [m] (`notch` may be repeated). Strengths spread
/// uniformly by the part S about their value. After a restart the same line makes nothing anew: the
/// restart file says that it was done, and with what spread. Several of these fixes add up; a pair
/// that two of them want is bonded by the first. Their strengths have one spread and seed.
///
/// The first of them also counts the bonds of particles that leave the box.
class FixBondCreate final : public LAMMPS_NS::Fix {
 public:
  FixBondCreate(LAMMPS_NS::LAMMPS* lammps, int narg, char** arg);

  ~FixBondCreate() override;

  int setmask() override;
  void init() override;
  void setup_pre_exchange() override;
  void pre_exchange() override { count_leaving(); }
  void setup(int vflag) override;
  void post_run() override;
  void write_restart(FILE* file) override;
  void restart(char* buffer) override;

 private:
  std::shared_ptr<BondBook> bonds_ = BondBook::of(lmp);
  /// What the line in the script says.
  struct Wish {
    BondRequest request;
    double spread = 0.0;
    unsigned long seed = 0;
  };
  int read_word(const std::string& word, std::span<char*> rest, Wish& wish);
  void check(const BondRequest& request);
  double read_spread(const char* value);
  std::set<std::pair<long, long>> read_list(const char* path);
  Notch read_notch(char** ends);
  void agree_on_spread(double spread, unsigned long seed);
  bool is_first() const;
  void refuse_other_ids();
  void count_leaving();
  void count_lost() const;
  void tell(long made, long found) const;
  void warn_of_long_step() const;
  void check_reach();
  bool done_ = false;          ///< bonds were made, in this run or before the restart
  bool between_runs_ = false;  ///< the script has had time to take particles out
  std::map<std::array<double, 3>, int> ids_;  ///< by place, of this process, at the end of a run
  long wanted_ = -1;                          ///< pairs of the list
};

}  // namespace dem
