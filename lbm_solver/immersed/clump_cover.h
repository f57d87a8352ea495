// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <span>

#include "lbm_solver/field/domain.h"
#include "lbm_solver/immersed/footprint.h"

namespace lbm {

/// Takes from the surface cells of one sphere of a clump what others of it cover there, too: with
/// theirs, what is left adds up to the fraction of their union. (In cells that it covers whole the
/// map's cap at 1 does the same.) By the lines that solid_fraction.h takes: along the axis that is
/// nearest to the normal, at Gauss points across it, each measured exactly.
/// @param footprint  of `sphere`, just written
/// @param sphere     as it is mapped, like the others
/// @param others     of the same clump, those that count before it
void take_union(Footprint& footprint, const Body& sphere, std::span<const Body> others,
                const Domain& domain);

}  // namespace lbm
