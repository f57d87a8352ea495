// SPDX-License-Identifier: GPL-2.0-or-later
/// What is kept of each particle travels with it, and into restart files.
#include <atom.h>
#include <memory.h>

#include <algorithm>

#include "liggghts_coupling/host/fix_lbm_couple.h"

namespace dem {

FixLbmCouple::~FixLbmCouple() {
  atom->delete_callback(id, 0);
  atom->delete_callback(id, 1);
  memory->destroy(held_);
}

void FixLbmCouple::grow_arrays(int n) {
  memory->grow(held_, n, kColumns, "lbm/couple:held");
  array_atom = held_;
}

void FixLbmCouple::copy_arrays(int from, int to, int) {
  std::copy_n(held_[from], kColumns, held_[to]);
}

void FixLbmCouple::set_arrays(int i) {
  std::fill_n(held_[i], kColumns, 0.0);
}

int FixLbmCouple::pack_exchange(int i, double* buffer) {
  std::copy_n(held_[i], kColumns, buffer);
  return kColumns;
}

int FixLbmCouple::unpack_exchange(int i, double* buffer) {
  std::copy_n(buffer, kColumns, held_[i]);
  return kColumns;
}

int FixLbmCouple::pack_restart(int i, double* buffer) {
  buffer[0] = kKept + 1;  // LIGGGHTS' convention: a fix's record begins with its length
  std::copy_n(held_[i], kKept, buffer + 1);
  return kKept + 1;
}

void FixLbmCouple::unpack_restart(int i, int nth) {
  const double* record = atom->extra[i];
  for (int n = 0; n < nth; ++n) record += static_cast<int>(record[0]);
  if (record[0] != kKept + 1)
    fail("the restart file is of another version of this fix; start again without it");
  set_arrays(i);
  std::copy_n(record + 1, kKept, held_[i]);
}

double FixLbmCouple::memory_usage() {
  return static_cast<double>(atom->nmax) * kColumns * sizeof(double);
}

}  // namespace dem
