// SPDX-License-Identifier: GPL-2.0-or-later
#include "liggghts_coupling/bond/fix_bond_create.h"

#include <comm.h>
#include <error.h>
#include <fmt/format.h>
#include <force.h>
#include <pair.h>
#include <update.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <fstream>
#include <limits>

#include "liggghts_coupling/bond/arguments.h"
#include "liggghts_coupling/bond/bond_book.h"
#include "liggghts_coupling/bond/pair_property.h"
#include "protocol/input_file.h"

namespace dem {
namespace {

/// What a restart file keeps, as doubles.
constexpr int kKept = 7;  // done, spread, seed, largest gap, created, broken by tension, by shear

}  // namespace

FixBondCreate::FixBondCreate(LAMMPS_NS::LAMMPS* lammps, int narg, char** arg)
    : Fix(lammps, narg, arg) {
  restart_global = 1;
  BondBook& book = BondBook::instance();
  BondRequest request;
  bool gap = false;
  for (int k = 3; k < narg;) {
    const std::string word = arg[k];
    const auto need = [&](int count) {
      if (k + count >= narg)
        error->fix_error(FLERR, this, ("'" + word + "' lacks its value").c_str());
    };
    if (word == "gap") {
      need(1);
      request.gap = argument<double>(error, this, word, arg[k + 1]);
      gap = true;
      k += 2;
    } else if (word == "types") {
      need(2);
      request.types = {argument<int>(error, this, word, arg[k + 1]),
                       argument<int>(error, this, word, arg[k + 2])};
      k += 3;
    } else if (word == "list") {
      need(1);
      request.listed = read_list(arg[k + 1]);
      wanted_ = static_cast<long>(request.listed->size());
      k += 2;
    } else if (word == "notch") {
      need(4);
      request.notches.push_back(read_notch(arg + k + 1));
      k += 5;
    } else if (word == "spread") {
      need(1);
      book.spread = argument<double>(error, this, word, arg[k + 1]);
      if (book.spread < 0.0 || book.spread >= 1.0)
        error->fix_error(FLERR, this, "spread is at least 0 and below 1");
      k += 2;
    } else if (word == "seed") {
      need(1);
      book.seed = static_cast<unsigned long>(argument<int>(error, this, word, arg[k + 1]));
      k += 2;
    } else {
      error->fix_error(FLERR, this,
                       ("knows no '" + word +
                        "'; use gap G [types A B] [list FILE] [notch X1 Y1 X2 Y2] "
                        "[spread S seed N]")
                           .c_str());
    }
  }
  if (!gap || request.gap < 0.0)
    error->fix_error(FLERR, this, "needs 'gap G', the largest gap in m, at least 0");
  if (request.listed && !request.notches.empty())
    error->fix_error(FLERR, this,
                     "takes 'list' or 'notch'; leave what the notch cuts out of the list");
  book.request = request;
}

Notch FixBondCreate::read_notch(char** ends) {
  const auto number = [&](int k) { return argument<double>(error, this, "notch", ends[k]); };
  const Notch notch{.from = {number(0), number(1)}, .to = {number(2), number(3)}};
  if (notch.from == notch.to)
    error->fix_error(FLERR, this, "notch X1 Y1 X2 Y2: its ends are the same point");
  return notch;
}

std::set<std::pair<long, long>> FixBondCreate::read_list(const char* path) {
  constexpr std::uintmax_t largest = 1'000'000'000;  // bytes: 5e7 pairs
  if (const auto problem = protocol::why_unreadable(path, largest); !problem.empty())
    error->fix_error(
        FLERR, this,
        fmt::format("list {}: {}; give a file of two ids a line", path, problem).c_str());
  std::ifstream file(path);
  std::set<std::pair<long, long>> listed;
  for (long a = 0, b = 0; file >> a >> b;) listed.emplace(std::min(a, b), std::max(a, b));
  if (!file.eof())
    error->fix_error(FLERR, this, (std::string(path) + ": two ids a line are wanted").c_str());
  return listed;
}

void FixBondCreate::init() {
  if (!force->pair || !force->pair_match("gran", 1))
    error->fix_error(FLERR, this, "needs pair_style gran model bond/contact");
}

/// The forces of the run's first step have been computed, and with them the bonds made.
void FixBondCreate::setup(int) {
  if (done_) return;
  done_ = true;
  BondBook& book = BondBook::instance();
  int ignored = book.request ? 1 : 0;  // the bonds' pair styles take the wish
  MPI_Allreduce(MPI_IN_PLACE, &ignored, 1, MPI_INT, MPI_MIN, world);
  if (ignored)
    error->fix_error(FLERR, this,
                     "needs pair_style gran model bond/contact or bond/parallel; this one makes no "
                     "bonds");
  long all = 0;
  MPI_Allreduce(&book.created, &all, 1, MPI_LONG, MPI_SUM, world);
  if (wanted_ >= 0 && all != wanted_)
    error->fix_error(FLERR, this,
                     fmt::format("{} of the {} listed pairs are no neighbours within the gap; give "
                                 "a larger gap or correct the list",
                                 wanted_ - all, wanted_)
                         .c_str());
  if (comm->me == 0) {
    if (all == 0)
      fmt::print(stderr,
                 "liggghts | warning | fix bond/create {} has made no bonds: no two particles are "
                 "within its gap; raise it, or let the packing come to rest before\n",
                 id);
    const std::string text = fmt::format("bonds created: {}\n", all);
    for (FILE* out : {screen, logfile})
      if (out) std::fputs(text.c_str(), out);
  }
  if (all > 0) warn_of_long_step();
  check_reach();
}

/// A bond that is made under pressure has no force at a gap only: it breaks further apart than one
/// that is made without, and the pairs of this run keep their history up to what was known before.
void FixBondCreate::check_reach() {
  double gap = 0.0;
  MPI_Allreduce(&BondBook::instance().largest_gap, &gap, 1, MPI_DOUBLE, MPI_MAX, world);
  BondBook::instance().largest_gap = gap;
  const double reserved = BondBook::instance().reserved_gap;
  if (gap <= reserved || update->firststep == update->laststep) return;
  error->fix_error(FLERR, this,
                   fmt::format("particles press on each other: a bond made there is without force "
                               "at a gap of {:.3g} m, and would be lost beyond {:.3g} m; write "
                               "'run 0' after this fix and before the next run",
                               gap, reserved)
                       .c_str());
}

/// Bonds that are too stiff for the step break by themselves: paper A Eq 8, without a safety
/// factor.
void FixBondCreate::warn_of_long_step() const {
  double lightest = std::numeric_limits<double>::max(), stiffest = 0.0;
  for (int i = 0; i < atom->nlocal; ++i) lightest = std::min(lightest, atom->rmass[i]);
  MPI_Allreduce(MPI_IN_PLACE, &lightest, 1, MPI_DOUBLE, MPI_MIN, world);
  for (const char* name : {"bondNormalStiffness", "bondShearStiffness"})
    if (const double* const* values = pair_property(*lmp, name, style))
      for (int a = 0; a < atom->ntypes; ++a)
        for (int b = 0; b < atom->ntypes; ++b) stiffest = std::max(stiffest, values[a][b]);
  const double limit = std::sqrt(lightest / stiffest);
  if (comm->me == 0 && update->dt > limit)
    fmt::print(stderr,
               "liggghts | warning | fix bond/create {}: the time step of {:.3g} s is above √(m/k) "
               "= {:.3g} s of the stiffest bond, which will break by itself; take more substeps, "
               "and fix bond/timestep to be sure\n",
               id, update->dt, limit);
}

void FixBondCreate::write_restart(FILE* file) {
  const BondBook& book = BondBook::instance();
  long mine[3] = {book.created, book.broken_tension, book.broken_shear}, all[3];
  MPI_Reduce(mine, all, 3, MPI_LONG, MPI_SUM, 0, world);
  double gap = 0.0;
  MPI_Reduce(&book.largest_gap, &gap, 1, MPI_DOUBLE, MPI_MAX, 0, world);
  if (comm->me != 0) return;
  const double kept[kKept] = {done_ ? 1.0 : 0.0,
                              book.spread,
                              static_cast<double>(book.seed),
                              gap,
                              static_cast<double>(all[0]),
                              static_cast<double>(all[1]),
                              static_cast<double>(all[2])};
  const int size = sizeof kept;
  std::fwrite(&size, sizeof size, 1, file);
  std::fwrite(kept, sizeof kept, 1, file);
}

void FixBondCreate::restart(char* buffer) {
  double kept[kKept];
  std::memcpy(kept, buffer, sizeof kept);
  BondBook& book = BondBook::instance();
  done_ = kept[0] != 0.0;
  if (!done_) return;
  book.request.reset();
  book.spread = kept[1];
  book.seed = static_cast<unsigned long>(kept[2]);
  book.largest_gap = kept[3];
  // sums over all ranks: one keeps them
  book.created = comm->me == 0 ? static_cast<long>(kept[4]) : 0;
  book.broken_tension = comm->me == 0 ? static_cast<long>(kept[5]) : 0;
  book.broken_shear = comm->me == 0 ? static_cast<long>(kept[6]) : 0;
}

}  // namespace dem
