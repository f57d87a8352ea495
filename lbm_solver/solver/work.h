// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include "lbm_solver/base/record.h"
#include "lbm_solver/solver/plan.h"

namespace lbm {

/// Work of a step in every layer of cells along each axis, in that of a cell of fluid.
using LayerWork = std::array<std::vector<double>, 3>;

/// From what covers the cells now: a SIMD block that holds a covered cell costs more, and most
/// where its body moves, which is then mapped anew (docs/parallel.md). Collective.
LayerWork work_of(const Fluid& fluid);

/// For a checkpoint, from which a run may go on with other blocks.
Record save(const LayerWork& work);
/// @throws std::invalid_argument  it is of another box
LayerWork load_work(const Record& record, const Domain& domain);

/// What is known of the work before a coupled run begins: of the scene's obstacles and of the
/// particles that it starts, not of those that the solid's script makes. Collective.
LayerWork first_work(const Scene& scene, const Plan& plan, const Decomposition& ranks);

/// The same grid of ranks with the cuts where the blocks between them have equal work.
Decomposition of_equal_work(const Decomposition& ranks, const LayerWork& work);

/// Work of the busiest block over the mean, as the layers tell it.
double imbalance(const Decomposition& ranks, const LayerWork& work);

/// ", cut along z at 12 30": where the blocks end.
std::string cuts_text(const Decomposition& ranks);
/// What the log says of blocks and their work.
std::string describe_blocks(const Decomposition& ranks, const LayerWork& work);

}  // namespace lbm
