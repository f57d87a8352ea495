// SPDX-License-Identifier: GPL-2.0-or-later
/// The library's classes must have here the layout they had when Debian built it: a compiler flag
/// or definition that changes one would corrupt memory without a word.
// The package's headers do not include what they use: this order compiles.
// clang-format off
#include <mpi.h>
#include <lammps.h>
#include <atom.h>
#include <fix.h>
#include <contact_models.h>
#include <fix_insert_stream.h>
#include <pair_gran_base.h>  // uses the generated style headers
// clang-format on

static_assert(sizeof(LAMMPS_NS::Atom) == 1480, "layout of Atom differs from LIGGGHTS 3.8.0");
static_assert(sizeof(LAMMPS_NS::Fix) == 544, "layout of Fix differs from LIGGGHTS 3.8.0");
static_assert(sizeof(LAMMPS_NS::PairGran) == 1152,
              "layout of PairGran differs from LIGGGHTS 3.8.0");
static_assert(sizeof(LCM::SurfacesIntersectData) == 368, "layout of contact data differs");
static_assert(sizeof(LAMMPS_NS::bigint) == 8 && sizeof(LAMMPS_NS::tagint) == 4, "integer sizes");
