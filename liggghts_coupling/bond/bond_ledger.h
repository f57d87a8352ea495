// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <mpi.h>

#include <string>

namespace dem {

struct BondBook;

/// The ledger of bonds as a restart file keeps it: the bonds that have broken, which of them are
/// not written to the table of breaks yet, and the energies. A line of text a value, by name:
///   rank R of N                       what follows is of this process
///   energy NAME VALUE                 [J]
///   broken NAME=VALUE …               a bond that broke
///   written STEP                      breaks up to this step are in the table
/// (How many were made and became of them, the fixes that make bonds keep.)

/// Of all processes, on the first one. Collective.
std::string save_ledger(const BondBook& book, MPI_Comm world);

/// Takes over a ledger, on the same number of processes each its own, else the first all of it.
/// @throws std::invalid_argument  a line that it does not know
void load_ledger(const std::string& text, BondBook& book, MPI_Comm world);

}  // namespace dem
