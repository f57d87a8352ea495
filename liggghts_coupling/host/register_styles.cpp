// SPDX-License-Identifier: GPL-2.0-or-later
#include "liggghts_coupling/host/register_styles.h"

#include <lammps.h>
#include <modify.h>

#include <map>
#include <string>

#include "liggghts_coupling/bond/fix_bond_breaks.h"
#include "liggghts_coupling/bond/fix_bond_create.h"
#include "liggghts_coupling/bond/fix_time_step.h"
#include "liggghts_coupling/host/fix_lbm_couple.h"

namespace dem {
namespace {

using LAMMPS_NS::Fix;
using LAMMPS_NS::LAMMPS;
using LAMMPS_NS::Modify;

using FixCreator = Fix* (*)(LAMMPS*, int, char**);
using FixMap = std::map<std::string, FixCreator>*;

// Modify::fix_map is private, and LIGGGHTS has no other registry for fixes. Access is not checked
// in the arguments of an explicit instantiation ([temp.spec]/6): the instantiation below hands the
// member pointer to a friend function.
struct FixMapTag {
  using type = FixMap Modify::*;
  friend type member(FixMapTag);
};
template <class Tag, typename Tag::type pointer>
struct Opener {
  friend typename Tag::type member(Tag) { return pointer; }
};
template struct Opener<FixMapTag, &Modify::fix_map>;

template <class Style>
Fix* create(LAMMPS* lammps, int narg, char** arg) {
  return new Style(lammps, narg, arg);
}

}  // namespace

void register_styles(LAMMPS& lammps) {
  FixMap fixes = lammps.modify->*member(FixMapTag());
  (*fixes)["lbm/couple"] = &create<FixLbmCouple>;
  (*fixes)["bond/create"] = &create<FixBondCreate>;
  (*fixes)["bond/breaks"] = &create<FixBondBreaks>;
  (*fixes)["bond/timestep"] = &create<FixTimeStep>;
}

}  // namespace dem
