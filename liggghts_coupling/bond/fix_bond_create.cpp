// SPDX-License-Identifier: GPL-2.0-or-later
#include "liggghts_coupling/bond/fix_bond_create.h"

#include <comm.h>
#include <error.h>
#include <fix_contact_history.h>
#include <fmt/core.h>
#include <force.h>
#include <modify.h>
#include <pair_gran.h>
#include <update.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <fstream>
#include <functional>
#include <limits>
#include <vector>

#include "liggghts_coupling/bond/arguments.h"
#include "liggghts_coupling/bond/bond_book.h"
#include "liggghts_coupling/bond/leaving.h"
#include "liggghts_coupling/bond/pair_property.h"
#include "protocol/program/input_file.h"

namespace dem {
namespace {

/// What a restart file keeps, as doubles: kLayout, done, spread, seed, largest gap, BondTally.
constexpr int kKept = 10;
constexpr double kLayout = 2.0;
constexpr std::array kCounts{&BondTally::created, &BondTally::tension, &BondTally::shear,
                             &BondTally::left, &BondTally::lost};
static_assert(kKept == 5 + kCounts.size());

long sum(long mine, MPI_Comm world) {
  long all = 0;
  MPI_Allreduce(&mine, &all, 1, MPI_LONG, MPI_SUM, world);
  return all;
}

/// Ids that any process names, on all of them.
std::set<int> everywhere(const std::vector<int>& mine, MPI_Comm world) {
  int ranks = 0, count = static_cast<int>(mine.size());
  MPI_Comm_size(world, &ranks);
  std::vector<int> counts(ranks), starts(ranks);
  MPI_Allgather(&count, 1, MPI_INT, counts.data(), 1, MPI_INT, world);
  for (int r = 1; r < ranks; ++r) starts[r] = starts[r - 1] + counts[r - 1];
  std::vector<int> all(starts.back() + counts.back());
  MPI_Allgatherv(mine.data(), count, MPI_INT, all.data(), counts.data(), starts.data(), MPI_INT,
                 world);
  return {all.begin(), all.end()};
}

}  // namespace

FixBondCreate::FixBondCreate(LAMMPS_NS::LAMMPS* lammps, int narg, char** arg)
    : Fix(lammps, narg, arg) {
  restart_global = 1;
  Wish wish{.request = {.fix = id, .gap = -1.0}};
  for (int k = 3; k < narg;) k += 1 + read_word(arg[k], {arg + k + 1, arg + narg}, wish);
  check(wish.request);
  if (wish.request.listed) wanted_ = static_cast<long>(wish.request.listed->size());
  agree_on_spread(wish.spread, wish.seed);
  bonds_->requests.push_back(wish.request);
}

/// @param rest  what comes behind the word @return  how many of those are its values
int FixBondCreate::read_word(const std::string& word, std::span<char*> rest, Wish& wish) {
  const auto number = [&](int k) { return argument<double>(error, this, word, rest[k]); };
  const auto whole = [&](int k) { return argument<int>(error, this, word, rest[k]); };
  struct Reader {
    int values;
    std::function<void()> read;
  };
  const std::map<std::string, Reader> readers{
      {"gap", {1, [&] { wish.request.gap = number(0); }}},
      {"types",
       {2,
        [&] {
          wish.request.types = {whole(0), whole(1)};
        }}},
      {"list", {1, [&] { wish.request.listed = read_list(rest[0]); }}},
      {"notch", {4, [&] { wish.request.notches.push_back(read_notch(rest.data())); }}},
      {"spread", {1, [&] { wish.spread = read_spread(rest[0]); }}},
      {"seed", {1, [&] { wish.seed = static_cast<unsigned long>(whole(0)); }}}};
  const auto reader = readers.find(word);
  if (reader == readers.end())
    error->fix_error(FLERR, this,
                     ("knows no '" + word +
                      "'; use gap G [types A B] [list FILE] [notch X1 Y1 X2 Y2] "
                      "[spread S seed N]")
                         .c_str());
  if (std::ssize(rest) < reader->second.values)
    error->fix_error(FLERR, this, ("'" + word + "' lacks its value").c_str());
  reader->second.read();
  return reader->second.values;
}

void FixBondCreate::check(const BondRequest& request) {
  if (request.gap < 0.0)
    error->fix_error(FLERR, this, "needs 'gap G', the largest gap in m, at least 0");
  if (request.listed && !request.notches.empty())
    error->fix_error(FLERR, this,
                     "takes 'list' or 'notch'; leave what the notch cuts out of the list");
}

FixBondCreate::~FixBondCreate() {
  std::erase_if(bonds_->requests, [&](const BondRequest& r) { return r.fix == id; });
}

int FixBondCreate::setmask() {
  return LAMMPS_NS::FixConst::PRE_EXCHANGE | LAMMPS_NS::FixConst::POST_RUN;
}

/// The strength of a bond is found anew from both at every step: they hold for all bonds.
void FixBondCreate::agree_on_spread(double spread, unsigned long seed) {
  BondBook& book = *bonds_;
  if (!book.has_spread) {
    book.spread = spread;
    book.seed = seed;
    book.has_spread = true;
  }
  if (book.spread == spread && book.seed == seed) return;
  error->fix_error(
      FLERR, this,
      fmt::format("has spread {} seed {}, an earlier fix bond/create has spread {} seed {}: they "
                  "hold for all bonds; give all of these fixes the same",
                  spread, seed, book.spread, book.seed)
          .c_str());
}

double FixBondCreate::read_spread(const char* value) {
  const auto spread = argument<double>(error, this, "spread", value);
  if (spread < 0.0 || spread >= 1.0)
    error->fix_error(FLERR, this, "spread is at least 0 and below 1");
  return spread;
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

bool FixBondCreate::is_first() const {
  return modify->find_fix_style_strict(style, 0) == this;
}

void FixBondCreate::setup_pre_exchange() {
  refuse_other_ids();
  count_leaving();
}

void FixBondCreate::post_run() {
  between_runs_ = true;
  if (!is_first()) return;
  for (int i = 0; i < atom->nlocal; ++i)
    ids_[{atom->x[i][0], atom->x[i][1], atom->x[i][2]}] = atom->tag[i];
}

/// LIGGGHTS knows the bonds of a particle by its id and those of its partners.
void FixBondCreate::refuse_other_ids() {
  const auto ids = std::exchange(ids_, {});
  if (!is_first() || sum(bonds_->tally.created, world) == 0) return;
  long others = 0;
  for (int i = 0; i < atom->nlocal; ++i) {
    const auto before = ids.find({atom->x[i][0], atom->x[i][1], atom->x[i][2]});
    others += before != ids.end() && before->second != atom->tag[i];
  }
  others = sum(others, world);
  if (others > 0)
    error->fix_error(FLERR, this,
                     fmt::format("{} particles have another id than in the last run, and bonds are "
                                 "known by ids; write 'delete_atoms … compress no'",
                                 others)
                         .c_str());
}

/// Counts the bonds of particles that the coming exchange takes out of the box. LIGGGHTS keeps the
/// pairs of each particle, on its process, beside the lists that forces are computed from.
void FixBondCreate::count_leaving() {
  auto* pair = dynamic_cast<LAMMPS_NS::PairGran*>(force->pair_match("gran", 1));
  if (!is_first() || !pair || !pair->get_fix_history()) return;
  std::vector<int> mine = leaving(*lmp, ~0);
  if (sum(static_cast<long>(mine.size()), world) == 0) return;
  LAMMPS_NS::FixContactHistory& pairs = *pair->get_fix_history();
  pairs.setup_pre_exchange();  // brings them up to date; to do so twice changes nothing
  BondBook& book = *bonds_;
  std::vector<int> ids;
  for (const int i : mine) ids.push_back(atom->tag[i]);
  const std::set<int> gone = everywhere(ids, world);
  for (const int i : mine)
    for (int n = 0; n < pairs.n_partner(i); ++n) {
      const int partner = pairs.partner(i, n);
      const bool bonded = pairs.contacthistory(i, n)[book.column] != 0.0;
      // where both leave, one of them counts
      if (bonded && (!gone.contains(partner) || atom->tag[i] < partner)) ++book.tally.left;
    }
}

/// Bonds that have vanished between two runs: with particles that the script has taken out.
void FixBondCreate::count_lost() const {
  BondBook& book = *bonds_;
  const BondTally& t = book.tally;
  const long lost = sum(t.created - book.intact - t.gone(), world);
  if (lost <= 0 || comm->me != 0) return;
  book.tally.lost += lost;
  fmt::print(stderr,
             "liggghts | warning | {} bonds were lost between two runs, with particles that the "
             "script took out or moved away\n",
             lost);
}

/// The forces of the run's first step have been computed, and with them the bonds made.
void FixBondCreate::setup(int) {
  const bool later_run = std::exchange(between_runs_, false);
  if (later_run && is_first()) count_lost();
  if (done_) return;
  done_ = true;
  const BondRequest& request = *bonds_->request_of(id);
  int ignored = request.open ? 1 : 0;  // the bonds' pair styles take the wish
  MPI_Allreduce(MPI_IN_PLACE, &ignored, 1, MPI_INT, MPI_MIN, world);
  if (ignored)
    error->fix_error(FLERR, this,
                     "needs pair_style gran model bond/contact or bond/parallel; this one makes no "
                     "bonds");
  const long made = sum(request.made, world), found = sum(request.found, world);
  if (wanted_ >= 0 && found != wanted_)
    error->fix_error(FLERR, this,
                     fmt::format("{} of the {} listed pairs are no neighbours within the gap; give "
                                 "a larger gap or correct the list",
                                 wanted_ - found, wanted_)
                         .c_str());
  tell(made, found);
  if (made > 0) warn_of_long_step();
  check_reach();
}

/// @param made, found  bonds, and pairs that it wants, of all processes
void FixBondCreate::tell(long made, long found) const {
  const long all = sum(bonds_->tally.created, world);
  if (comm->me != 0) return;
  if (found == 0)
    fmt::print(stderr,
               "liggghts | warning | fix bond/create {} has made no bonds: no two particles {}are "
               "within its gap; raise it, or let the packing come to rest before\n",
               id, bonds_->request_of(id)->types ? "of its types " : "");
  std::string text = fmt::format("bonds created: {} by fix bond/create {}", made, id);
  if (found > made) text += fmt::format(" ({} of its pairs were bonded before)", found - made);
  if (all != made) text += fmt::format("; {} in all", all);
  for (FILE* out : {screen, logfile})
    if (out) std::fputs((text + "\n").c_str(), out);
}

/// A bond that is made under pressure has no force at a gap only: it breaks further apart than one
/// that is made without, and the pairs of this run keep their history up to what was known before.
void FixBondCreate::check_reach() {
  double gap = 0.0;
  MPI_Allreduce(&bonds_->largest_gap, &gap, 1, MPI_DOUBLE, MPI_MAX, world);
  bonds_->largest_gap = gap;
  const double reserved = bonds_->reserved_gap;
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
  const BondBook& book = *bonds_;
  double gap = 0.0;
  MPI_Reduce(&book.largest_gap, &gap, 1, MPI_DOUBLE, MPI_MAX, 0, world);
  std::array<double, kKept> kept{kLayout, done_ ? 1.0 : 0.0, book.spread,
                                 static_cast<double>(book.seed), gap};
  for (std::size_t k = 0; k < kCounts.size(); ++k)
    kept[5 + k] = static_cast<double>(sum(book.tally.*kCounts[k], world));
  if (comm->me != 0) return;
  const int size = sizeof kept;
  std::fwrite(&size, sizeof size, 1, file);
  std::fwrite(kept.data(), size, 1, file);
}

void FixBondCreate::restart(char* buffer) {
  std::array<double, kKept> kept;
  std::memcpy(kept.data(), buffer, sizeof kept[0]);
  if (kept[0] != kLayout)
    error->fix_error(FLERR, this,
                     "the restart file is of another version of this fix; start again without it");
  std::memcpy(kept.data(), buffer, sizeof kept);
  done_ = kept[1] != 0.0;
  if (!done_) return;
  BondBook& book = *bonds_;
  book.request_of(id)->open = false;
  book.spread = kept[2];
  book.seed = static_cast<unsigned long>(kept[3]);
  book.largest_gap = kept[4];
  // sums over all ranks: one keeps them
  for (std::size_t k = 0; k < kCounts.size(); ++k)
    book.tally.*kCounts[k] = comm->me == 0 ? static_cast<long>(kept[5 + k]) : 0;
}

}  // namespace dem
