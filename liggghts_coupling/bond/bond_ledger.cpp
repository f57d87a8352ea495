// SPDX-License-Identifier: GPL-2.0-or-later
#include "liggghts_coupling/bond/bond_ledger.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <sstream>
#include <stdexcept>
#include <utility>
#include <vector>

#include "liggghts_coupling/bond/bond_book.h"

namespace dem {
namespace {

/// What has added up since the beginning; the elastic energy is found anew at every step.
constexpr std::array<std::pair<const char*, double EnergyFlow::*>, 4> kEnergies{
    {{"friction", &EnergyFlow::friction},
     {"damping", &EnergyFlow::damping},
     {"released", &EnergyFlow::released},
     {"stiffness_change", &EnergyFlow::stiffness_change}}};

constexpr const char* kTension = "tension";
constexpr const char* kShear = "shear";

// Numbers are written so that they read back the same, every bit.

std::string line_of(const BreakEvent& e) {
  return fmt::format("broken {} {} {} {} {} {} {} {} {} {} {} {}\n", e.step, e.time, e.first,
                     e.second, e.mode == Break::Tension ? kTension : kShear, e.force, e.place[0],
                     e.place[1], e.place[2], e.normal[0], e.normal[1], e.normal[2]);
}

BreakEvent event_of(std::istringstream& line) {
  BreakEvent e;
  std::string mode;
  line >> e.step >> e.time >> e.first >> e.second >> mode >> e.force;
  for (Vector* v : {&e.place, &e.normal})
    for (double& component : *v) line >> component;
  e.mode = mode == kTension ? Break::Tension : mode == kShear ? Break::Shear : Break::None;
  if (e.mode == Break::None) line.setstate(std::ios::failbit);
  return e;
}

std::string save_mine(const BondBook& book, int rank, int ranks) {
  std::string text = fmt::format("rank {} of {}\nwritten {}\n", rank, ranks, book.written_until);
  for (const auto& [name, member] : kEnergies)
    text += fmt::format("energy {} {}\n", name, book.energy.*member);
  for (const BreakEvent& e : book.broken) text += line_of(e);
  return text;
}

void take(const std::string& word, std::istringstream& line, BondBook& book) {
  if (word == "written") {
    line >> book.written_until;
  } else if (word == "energy") {
    std::string name;
    double value = 0.0;
    line >> name >> value;
    for (const auto& [known, member] : kEnergies)
      if (name == known) book.energy.*member += value;
  } else if (word == "broken") {
    book.broken.push_back(event_of(line));
    if (line && book.broken.back().step > book.written_until)
      book.events.push_back(book.broken.back());
  } else {
    line.setstate(std::ios::failbit);
  }
}

}  // namespace

std::string save_ledger(const BondBook& book, MPI_Comm world) {
  int rank = 0, ranks = 1;
  MPI_Comm_rank(world, &rank);
  MPI_Comm_size(world, &ranks);
  const std::string mine = save_mine(book, rank, ranks);
  const int size = static_cast<int>(mine.size());
  std::vector<int> sizes(ranks), starts(ranks);
  MPI_Gather(&size, 1, MPI_INT, sizes.data(), 1, MPI_INT, 0, world);
  for (int r = 1; r < ranks; ++r) starts[r] = starts[r - 1] + sizes[r - 1];
  std::string all(rank == 0 ? static_cast<std::size_t>(starts.back()) + sizes.back() : 0, ' ');
  MPI_Gatherv(mine.data(), size, MPI_CHAR, all.data(), sizes.data(), starts.data(), MPI_CHAR, 0,
              world);
  return all;
}

void load_ledger(const std::string& text, BondBook& book, MPI_Comm world) {
  int rank = 0, ranks = 1;
  MPI_Comm_rank(world, &rank);
  MPI_Comm_size(world, &ranks);
  book.broken.clear();
  book.events.clear();
  book.energy = {};
  std::istringstream lines(text);
  bool mine = false;
  for (std::string one; std::getline(lines, one);) {
    std::istringstream line(one);
    std::string word, of;
    line >> word;
    if (word == "rank") {
      int writer = 0, writers = 0;
      line >> writer >> of >> writers;
      mine = writers == ranks ? writer == rank : rank == 0;
    } else if (mine) {
      take(word, line, book);
    }
    if (!line) throw std::invalid_argument("the ledger of bonds has a line '" + one + "'");
  }
}

}  // namespace dem
