// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include "lbm_solver/base/record.h"
#include "lbm_solver/field/decomposition.h"

namespace lbm {

/// A state that was saved on some blocks, as `load` wants it on others: the values that rank 0 has
/// on every rank, and of each list of cells those of the rank's new block, in memory. Cells travel
/// from rank to rank in pieces of some megabytes. Collective; both have the same ranks.
/// @param record  just saved: parts that have cells are there on every rank
Record moved(const Record& record, const Decomposition& from, const Decomposition& to);

}  // namespace lbm
