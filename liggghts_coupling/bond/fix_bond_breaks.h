// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <mpi.h>

#include <memory>
#include <string>
// clang-format off
#include <lammps.h>
#include <fix.h>
// clang-format on

#include "liggghts_coupling/bond/bond_book.h"

namespace dem {

/// fix ID all bond/breaks every N file FILE
///
/// Every N steps, and at the end of a run: writes each break as a line of FILE (step, time, ids,
/// mode, force, place, orientation; a run that goes on keeps the lines before it), and checks that
/// bonds created = intact + broken + gone with a particle. In a coupled run the time is the
/// fluid's, and what broke before it has a time below 0.
///
/// Values f_ID[1…11]: bonds intact, broken by tension, broken by shear, created; with `ledger on`
/// of the pair style energies [J]: elastic, and since the beginning taken by friction, by damping,
/// released by tension breaks, stiffness change of shear breaks; bonds gone with a particle that
/// left the box, with one that was taken out.
class FixBondBreaks final : public LAMMPS_NS::Fix {
 public:
  FixBondBreaks(LAMMPS_NS::LAMMPS* lammps, int narg, char** arg);

  int setmask() override;
  void init() override;
  void end_of_step() override;
  void post_run() override { write(); }
  double compute_vector(int n) override;

 private:
  std::shared_ptr<BondBook> bonds_ = BondBook::of(lmp);
  void open(const std::string& kept);
  void move_times();
  void write();
  void check_counts();

  struct Close {
    void operator()(FILE* f) const { std::fclose(f); }
  };
  std::string path_;
  long first_step_ = 0;                // at which the times written so far are 0
  std::unique_ptr<FILE, Close> file_;  // rank 0
};

}  // namespace dem
