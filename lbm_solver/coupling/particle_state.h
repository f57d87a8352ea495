// SPDX-License-Identifier: GPL-2.0-or-later
/// What a checkpoint keeps of the carriers: their past, by the names of its parts.
#pragma once

#include <span>
#include <vector>

#include "lbm_solver/base/record.h"
#include "lbm_solver/coupling/carrier.h"
#include "lbm_solver/field/decomposition.h"

namespace lbm {

/// @param mine   of the carriers whose home this rank is
/// @param loads  whole ones that take the place of those in `mine`, by id; on rank 0
/// @return complete on rank 0. Collective
Record save_past(const Decomposition& ranks, std::span<const Past> mine,
                 std::span<const protocol::Load> loads);
/// @throws std::invalid_argument where it is no record of particles
std::vector<Past> load_past(const Record& record);

}  // namespace lbm
