// SPDX-License-Identifier: GPL-2.0-or-later
#include "liggghts_coupling/bond/fix_bond_breaks.h"

#include <comm.h>
#include <error.h>
#include <fmt/core.h>
#include <force.h>
#include <sys/stat.h>
#include <update.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <fstream>
#include <limits>
#include <sstream>
#include <tuple>
#include <vector>

#include "liggghts_coupling/bond/arguments.h"
#include "liggghts_coupling/bond/bond_book.h"

namespace dem {
namespace {

constexpr const char* kColumns =
    "step [1],time [s],id1 [1],id2 [1],mode,force [N],x [m],y [m],z [m],nx [1],ny [1],nz [1]\n";

/// A line with the time that belongs to its step.
std::string timed(const std::string& line, long first_step, double dt) {
  const std::size_t step_end = line.find(','), time_end = line.find(',', step_end + 1);
  if (time_end == std::string::npos) return line;
  const long step = std::strtol(line.c_str(), nullptr, 10);
  return fmt::format("{},{}{}", step, static_cast<double>(step - first_step) * dt,
                     line.substr(time_end));
}

/// Lines of an earlier run up to a step.
std::string kept_lines(const std::string& path, long before) {
  std::ifstream file(path);
  std::string line, kept;
  std::getline(file, line);
  while (std::getline(file, line) && !file.eof()) {  // not a line that a kill has cut off
    long step = 0;
    if (std::istringstream(line) >> step && step <= before) kept += line + "\n";
  }
  return kept;
}

std::string text(const BreakEvent& e) {
  return fmt::format("{},{},{},{},{},{},{},{},{},{},{},{}\n", e.step, e.time, e.first, e.second,
                     e.mode == Break::Tension ? "tension" : "shear", e.force, e.place[0],
                     e.place[1], e.place[2], e.normal[0], e.normal[1], e.normal[2]);
}

}  // namespace

FixBondBreaks::FixBondBreaks(LAMMPS_NS::LAMMPS* lammps, int narg, char** arg)
    : Fix(lammps, narg, arg) {
  vector_flag = 1;
  size_vector = 11;
  global_freq = 1;
  extvector = 1;
  for (int k = 3; k + 1 < narg; k += 2) {
    const std::string word = arg[k];
    if (word == "every")
      nevery = argument<int>(error, this, word, arg[k + 1]);
    else if (word == "file")
      path_ = arg[k + 1];
    else
      path_.clear();
  }
  if (narg != 7 || path_.empty() || nevery < 1)
    error->fix_error(FLERR, this, "expects 'every N file FILE' with N at least 1");
}

int FixBondBreaks::setmask() {
  return LAMMPS_NS::FixConst::END_OF_STEP | LAMMPS_NS::FixConst::POST_RUN;
}

void FixBondBreaks::init() {
  if (comm->me != 0 || file_) return;
  // breaks that were not written yet when the run was stopped, the ledger has
  const long ledger = bonds_->written_until;
  const auto now = static_cast<long>(update->ntimestep);
  open(now > 0 ? kept_lines(path_, ledger >= 0 ? ledger : now) : "");
}

/// The coupled run has begun since: what was written before it lies before the time 0.
void FixBondBreaks::move_times() {
  const long first_step = bonds_->first_step;
  if (first_step == first_step_ || !file_) return;
  first_step_ = first_step;
  std::istringstream before(kept_lines(path_, std::numeric_limits<long>::max()));
  std::string line, lines;
  while (std::getline(before, line)) lines += timed(line, first_step, update->dt) + "\n";
  open(lines);
}

void FixBondBreaks::open(const std::string& kept) {
  // under another name, or a kill at this moment would lose the lines of the run before
  const std::string part = path_ + ".part";
  file_.reset(std::fopen(part.c_str(), "w"));
  if (!file_)
    error->one(FLERR, ("fix bond/breaks: " + path_ +
                       " cannot be written; give a file in a folder that exists")
                          .c_str());
  std::fputs((kColumns + kept).c_str(), file_.get());
  if (std::fflush(file_.get()) != 0 || std::rename(part.c_str(), path_.c_str()) != 0)
    error->one(FLERR,
               ("fix bond/breaks: " + path_ + " cannot be written; is the disk full?").c_str());
}

void FixBondBreaks::end_of_step() {
  write();
  check_counts();
}

/// Gathers the events of all ranks; in the file they are in the order of steps and ids.
void FixBondBreaks::write() {
  move_times();
  std::vector<BreakEvent>& mine = bonds_->events;
  const int bytes = static_cast<int>(mine.size() * sizeof(BreakEvent));
  std::vector<int> sizes(comm->nprocs), starts(comm->nprocs);
  MPI_Gather(&bytes, 1, MPI_INT, sizes.data(), 1, MPI_INT, 0, world);
  for (int r = 1; r < comm->nprocs; ++r) starts[r] = starts[r - 1] + sizes[r - 1];
  std::vector<BreakEvent> all(
      comm->me == 0 ? static_cast<std::size_t>(starts.back() + sizes.back()) / sizeof(BreakEvent)
                    : 0);
  MPI_Gatherv(mine.data(), bytes, MPI_BYTE, all.data(), sizes.data(), starts.data(), MPI_BYTE, 0,
              world);
  mine.clear();
  bonds_->written_until = static_cast<long>(update->ntimestep);
  std::sort(all.begin(), all.end(), [](const BreakEvent& a, const BreakEvent& b) {
    return std::tuple(a.step, a.first, a.second) < std::tuple(b.step, b.first, b.second);
  });
  if (!file_) return;
  for (const BreakEvent& e : all) std::fputs(text(e).c_str(), file_.get());
  struct stat status {};
  const bool written = std::fflush(file_.get()) == 0 && !std::ferror(file_.get());
  if (written && fstat(fileno(file_.get()), &status) == 0 && status.st_nlink > 0) return;
  error->one(FLERR, fmt::format("fix bond/breaks: {} {}", path_,
                                written ? "was deleted while the run was writing it; start the "
                                          "run again, and leave its folder alone until it has ended"
                                        : "cannot be written; is the disk full?")
                        .c_str());
}

void FixBondBreaks::check_counts() {
  const BondBook& book = *bonds_;
  const long mine[3] = {book.tally.created, book.intact, book.tally.gone()};
  long all[3];
  MPI_Allreduce(mine, all, 3, MPI_LONG, MPI_SUM, world);
  if (all[0] != all[1] + all[2])
    error->fix_error(
        FLERR, this,
        fmt::format(
            "step {}: {} bonds were created, but {} are intact and {} broken or gone with a "
            "particle: {} were lost without breaking (did a fix take out particles during a run, "
            "or "
            "did one move on by more than the skin of the neighbour list in a step?)",
            static_cast<long>(update->ntimestep), all[0], all[1], all[2], all[0] - all[1] - all[2])
            .c_str());
}

double FixBondBreaks::compute_vector(int n) {
  const BondBook& b = *bonds_;
  const std::array<double, 11> values{static_cast<double>(b.intact),
                                      static_cast<double>(b.tally.tension),
                                      static_cast<double>(b.tally.shear),
                                      static_cast<double>(b.tally.created),
                                      b.energy.elastic,
                                      b.energy.friction,
                                      b.energy.damping,
                                      b.energy.released,
                                      b.energy.stiffness_change,
                                      static_cast<double>(b.tally.left),
                                      static_cast<double>(b.tally.lost)};
  double all = 0.0;
  MPI_Allreduce(&values[n], &all, 1, MPI_DOUBLE, MPI_SUM, world);
  return all;
}

}  // namespace dem
