// SPDX-License-Identifier: GPL-2.0-or-later
#include "liggghts_coupling/bond/bond_book.h"

#include <map>

namespace dem {

/// The registry owns nothing. No other place can be the owner: a script may have the pair style and
/// any of the fixes without the others and in any order, a fix may be undone by `unfix`, and
/// LIGGGHTS deletes the pair style before the fixes that count its bonds.
std::shared_ptr<BondBook> BondBook::of(const LAMMPS_NS::LAMMPS* lammps) {
  static std::map<const LAMMPS_NS::LAMMPS*, std::weak_ptr<BondBook>> books;
  std::shared_ptr<BondBook> book = books[lammps].lock();
  if (!book) books[lammps] = book = std::make_shared<BondBook>();
  return book;
}

BondRequest* BondBook::request_of(const std::string& fix) {
  const auto found = std::find_if(requests.begin(), requests.end(),
                                  [&](const BondRequest& r) { return r.fix == fix; });
  return found == requests.end() ? nullptr : &*found;
}

}  // namespace dem
